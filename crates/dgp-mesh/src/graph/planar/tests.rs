//! Theorems: Kuratowski, Euler, six and five colors.

use proptest::prelude::*;

use super::{
    super::{edge_bound, five_coloring, smallest_last_coloring},
    *,
};
use crate::{DVec3, EdgeId, Progress, VertexId, shapes};

fn complete(n: usize) -> Graph {
    let edges: Vec<_> = (0..n).flat_map(|i| (0..i).map(move |j| [j, i])).collect();
    Graph::from_indices(n, &edges).unwrap()
}

fn complete_bipartite(n: usize, m: usize) -> Graph {
    let edges: Vec<_> = (0..n).flat_map(|i| (0..m).map(move |j| [i, n + j])).collect();
    Graph::from_indices(n + m, &edges).unwrap()
}

/// Ten vertices, each of degree 3, no cycle shorter than 5.
fn petersen() -> Graph {
    let edges: Vec<_> =
        (0..5).flat_map(|i| [[i, (i + 1) % 5], [i, i + 5], [5 + i, 5 + (i + 2) % 5]]).collect();
    Graph::from_indices(10, &edges).unwrap()
}

/// Either answer with its proof checked; returns whether the graph is planar.
fn checked(graph: &Graph) -> bool {
    let embedding = planar_embedding(graph);
    let obstruction = kuratowski(graph, Progress::NONE).unwrap();
    assert_eq!(embedding.is_some(), is_planar(graph));
    assert_eq!(embedding.is_some(), obstruction.is_none());
    if let Some(embedding) = &embedding {
        assert_eq!(embedding.genus(), 0);
        for v in graph.vertices() {
            let mut arcs = embedding.arcs(v).to_vec();
            arcs.sort_unstable();
            assert_eq!(arcs, graph.arcs(v), "the embedding has the edges of the graph");
        }
        let sides: usize = embedding.faces().iter().map(Vec::len).sum();
        assert_eq!(sides, 2 * graph.edge_count());
        assert!(!edge_bound(graph).proves_non_planar);
        let six = smallest_last_coloring(graph);
        assert!(six.is_proper(graph) && six.count <= 6 && six.degeneracy <= 5);
        let five = five_coloring(graph).expect("the five color theorem");
        assert!(five.is_proper(graph) && five.count <= 5);
    }
    if let Some(obstruction) = &obstruction {
        check_subdivision(graph, obstruction);
    }
    embedding.is_some()
}

/// Follows the paths between branch vertices: they join them as in K5 or K3,3, and use all edges.
fn check_subdivision(graph: &Graph, obstruction: &Obstruction) {
    let part = graph.with_edges(&obstruction.edges);
    let branch = &obstruction.branch_vertices;
    let mut joined = Vec::new();
    let mut used = 0;
    for (i, &start) in branch.iter().enumerate() {
        for &(first, edge) in part.arcs(start) {
            let (mut at, mut last) = (first, edge);
            used += 1;
            while !branch.contains(&at) {
                assert_eq!(part.degree(at), 2);
                let &(next, edge) = part.arcs(at).iter().find(|arc| arc.1 != last).unwrap();
                (at, last) = (next, edge);
                used += 1;
            }
            joined.push([i, branch.iter().position(|&b| b == at).unwrap()]);
        }
    }
    assert_eq!(used, 2 * part.edge_count(), "nothing but the paths");
    joined.sort_unstable();
    let before = joined.len();
    joined.dedup();
    assert_eq!(joined.len(), before, "one path between two branch vertices");
    match obstruction.kind {
        Kuratowski::K5 => assert_eq!((branch.len(), joined.len()), (5, 20)),
        Kuratowski::K33 => {
            assert_eq!((branch.len(), joined.len()), (6, 18));
            let small: Vec<[usize; 2]> = joined.into_iter().filter(|[a, b]| a < b).collect();
            let quotient = Graph::from_indices(6, &small).unwrap();
            assert!(super::super::bipartition(&quotient).is_some());
        }
    }
    for &e in &obstruction.edges {
        let rest: Vec<EdgeId> = obstruction.edges.iter().copied().filter(|&f| f != e).collect();
        assert!(is_planar(&graph.with_edges(&rest)), "it is minimal");
    }
}

#[test]
fn small_graphs_are_what_everybody_knows() {
    assert!(checked(&complete(4)) && !checked(&complete(5)) && !checked(&complete(9)));
    assert!(checked(&complete_bipartite(2, 9)) && !checked(&complete_bipartite(3, 3)));
    assert!(!checked(&petersen()));
    let kind = |graph: &Graph| kuratowski(graph, Progress::NONE).unwrap().unwrap().kind;
    assert_eq!(kind(&complete(5)), Kuratowski::K5);
    assert_eq!(kind(&complete_bipartite(3, 4)), Kuratowski::K33);
    // It has K5 as a minor, but as its degrees are 3 only K3,3 as a subdivision.
    assert_eq!(kind(&petersen()), Kuratowski::K33);
    for n in 0..3 {
        assert!(checked(&complete(n)));
    }
}

#[test]
fn without_any_one_edge_the_two_are_planar() {
    for graph in [complete(5), complete_bipartite(3, 3)] {
        for left_out in 0..graph.edge_count() {
            let rest: Vec<EdgeId> =
                (0..graph.edge_count()).filter(|&e| e != left_out).map(EdgeId::new).collect();
            assert!(checked(&graph.with_edges(&rest)));
        }
    }
}

#[test]
fn the_bounds_refuse_k5_and_k33_and_say_nothing_of_petersen() {
    let k5 = edge_bound(&complete(5));
    assert_eq!((k5.limit, k5.bipartite_limit, k5.proves_non_planar), (Some(9), None, true));
    let k33 = edge_bound(&complete_bipartite(3, 3));
    assert_eq!((k33.limit, k33.bipartite_limit, k33.proves_non_planar), (Some(12), Some(8), true));
    assert!(!edge_bound(&petersen()).proves_non_planar);
    // Triangulations of the sphere reach the first bound, quadrangulations the second.
    let bound = edge_bound(&Graph::of_mesh(&shapes::icosphere(2).unwrap()));
    assert_eq!(Some(bound.edges), bound.limit);
    let bound = edge_bound(&Graph::of_mesh(&shapes::quad_sphere(4).unwrap()));
    assert_eq!(Some(bound.edges), bound.bipartite_limit);
}

#[test]
fn edges_of_spheres_are_planar_with_the_faces_of_the_mesh_and_those_of_tori_are_not() {
    let genus_0 = [
        shapes::icosphere(4).unwrap(),
        shapes::dodecahedron(),
        shapes::quad_sphere(5).unwrap(),
        shapes::uv_sphere(12, 7).unwrap(),
        shapes::truncated_icosahedron(),
        shapes::goldberg(2, 1).unwrap(),
    ];
    for mesh in genus_0 {
        let graph = Graph::of_mesh(&mesh);
        let embedding = planar_embedding(&graph).unwrap();
        assert_eq!(embedding.genus(), 0);
        // All are 3-connected, so that there is only one drawing but for its mirror image (Whitney).
        let normalized = |mut face: Vec<VertexId>| {
            face.sort_unstable();
            face
        };
        let mut drawn: Vec<_> = embedding.faces().into_iter().map(normalized).collect();
        let mut faces: Vec<_> =
            mesh.faces().map(|f| normalized(mesh.face_vertices(f).collect())).collect();
        drawn.sort_unstable();
        faces.sort_unstable();
        assert!(drawn == faces);
        assert!(five_coloring(&graph).unwrap().count <= 5);
    }
    for mesh in [
        shapes::torus(2.0, 1.0, 8, 5).unwrap(),
        shapes::quad_torus(2.0, 1.0, 9, 6).unwrap(),
        shapes::surface_of_genus(2, 2).unwrap(),
    ] {
        assert!(!checked(&Graph::of_mesh(&mesh)));
    }
    let open = shapes::with_holes(&shapes::icosphere(3).unwrap(), 5, 2, 1).unwrap();
    assert!(checked(&Graph::of_mesh(&open)));
    assert!(checked(&Graph::of_mesh(&shapes::annulus(1.0, 2.0, 9, 3).unwrap())));
}

#[test]
fn long_paths_and_many_parts_are_no_danger() {
    let n = 200_000;
    let path: Vec<[usize; 2]> = (1..n).map(|v| [v - 1, v]).collect();
    let embedding = planar_embedding(&Graph::from_indices(n, &path).unwrap()).unwrap();
    assert_eq!((embedding.genus(), embedding.faces().len()), (0, 1));
    let pairs: Vec<[usize; 2]> = (0..n / 2).map(|k| [2 * k, 2 * k + 1]).collect();
    assert!(is_planar(&Graph::from_indices(n, &pairs).unwrap()));
}

#[test]
fn loops_and_repeated_edges_change_nothing_and_wrong_ends_are_refused() {
    let graph = Graph::from_indices(3, &[[0, 1], [1, 1], [1, 0], [1, 2]]).unwrap();
    assert_eq!(graph.edges(), [[0, 1], [1, 2]].map(|ends| ends.map(VertexId::new)));
    assert!(Graph::from_indices(3, &[[0, 3]]).is_err());
}

/// The surface of a random convex-like cloud: edges of a triangulated sphere with some flipped.
fn random_graph(n: usize, edges: &[(u16, u16)]) -> Graph {
    let edges: Vec<_> = edges.iter().map(|&(a, b)| [a as usize % n, b as usize % n]).collect();
    Graph::from_indices(n, &edges).unwrap()
}

proptest! {
    #[test]
    fn random_graphs_are_embedded_or_obstructed(
        n in 1..14_usize,
        edges in proptest::collection::vec((0..100_u16, 0..100_u16), 0..34),
    ) {
        checked(&random_graph(n, &edges));
    }

    #[test]
    fn parts_of_planar_graphs_are_planar_and_one_edge_too_many_is_found(
        kept in proptest::collection::vec(any::<bool>(), 120),
        order in proptest::collection::vec(0..1000_u32, 42),
        extra in (0..42_usize, 0..42_usize),
    ) {
        let sphere = Graph::of_mesh(&shapes::icosphere(1).unwrap());
        let mut names: Vec<usize> = (0..42).collect();
        names.sort_by_key(|&v| order[v]);
        let rename = |ends: [VertexId; 2]| ends.map(|v| names[v.index()]);
        let mut edges: Vec<[usize; 2]> =
            sphere.edges().iter().zip(&kept).filter(|(_, kept)| **kept).map(|(e, _)| rename(*e)).collect();
        prop_assert!(checked(&Graph::from_indices(42, &edges).unwrap()));
        edges.push([extra.0, extra.1]);
        checked(&Graph::from_indices(42, &edges).unwrap());
    }
}

#[test]
fn a_drawing_on_the_sphere_is_counterclockwise_or_clockwise_everywhere() {
    let mesh = shapes::icosphere(2).unwrap();
    let embedding = planar_embedding(&Graph::of_mesh(&mesh)).unwrap();
    let turn = |v: VertexId| {
        let around = embedding.arcs(v);
        let [a, b] = [around[0].0, around[1].0].map(|w| mesh.position(w));
        let p: DVec3 = mesh.position(v);
        (a - p).cross(b - p).dot(p) > 0.0
    };
    let first = turn(VertexId::new(0));
    assert!(mesh.vertices().all(|v| turn(v) == first));
}
