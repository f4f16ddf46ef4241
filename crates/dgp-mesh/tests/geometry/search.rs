//! Shortest paths against petgraph, on the same graph.

use dgp_mesh::{
    EdgeMap, Error, Mesh, Progress, VertexId, VertexSet,
    graph::{Until, astar, breadth_first, dijkstra},
    measure::edge_lengths,
    shapes::{self, Random},
};
use petgraph::graph::{NodeIndex, UnGraph};

use crate::meshes;

/// The edges of a mesh as a graph of petgraph.
fn graph_of(mesh: &Mesh, lengths: &EdgeMap<f64>) -> UnGraph<(), f64> {
    let mut graph = UnGraph::new_undirected();
    for _ in mesh.vertices() {
        graph.add_node(());
    }
    for e in mesh.edges() {
        let [a, b] = mesh.edge_vertices(e).map(|v| NodeIndex::new(v.index()));
        graph.add_edge(a, b, lengths[e]);
    }
    graph
}

/// Lengths in space, and random ones that have nothing to do with them, zeros included.
fn weightings(mesh: &Mesh) -> [EdgeMap<f64>; 2] {
    let mut random = Random::new(3);
    let other = EdgeMap::from_fn(mesh.edge_count(), |_| (random.uniform() * 8.0).floor() / 4.0);
    [edge_lengths(mesh), other]
}

#[test]
fn distances_are_those_of_petgraph() {
    for (name, mesh) in meshes() {
        for lengths in weightings(&mesh) {
            let graph = graph_of(&mesh, &lengths);
            let source = VertexId::new(mesh.vertex_count() / 2);
            let found =
                dijkstra(&mesh, &lengths, &[source], Until::AllReached, Progress::NONE).unwrap();
            let start = NodeIndex::new(source.index());
            let expected = petgraph::algo::dijkstra(&graph, start, None, |e| *e.weight());
            for v in mesh.vertices() {
                let distance = expected.get(&NodeIndex::new(v.index()));
                assert_eq!(found.distance[v], distance.copied().unwrap_or(f64::INFINITY), "{name}");
                let path = found.path(&mesh, v).unwrap();
                let length = path.iter().fold(0.0, |sum, h| sum + lengths[h.edge()]);
                assert_eq!(length, found.distance[v], "{name} {v}");
                assert_eq!(path.first().map_or(v, |&h| mesh.from(h)), source, "{name} {v}");
            }
            assert!(found.order.windows(2).all(|w| found.distance[w[0]] <= found.distance[w[1]]));
        }
    }
}

#[test]
fn astar_finds_paths_as_short_and_looks_at_less() {
    let mut random = Random::new(9);
    let (mut looked, mut all) = (0, 0);
    for (name, mesh) in meshes() {
        for (k, lengths) in weightings(&mesh).iter().enumerate() {
            for _ in 0..5 {
                let [a, b] = [(); 2].map(|()| VertexId::new(random.below(mesh.vertex_count())));
                let targets: VertexSet = [b].into_iter().collect();
                let until = Until::Reached(&targets);
                let exact = dijkstra(&mesh, lengths, &[a], until, Progress::NONE).unwrap();
                let path = astar(&mesh, lengths, a, b, Progress::NONE).unwrap().unwrap();
                assert_eq!(path.length, exact.distance[b], "{name} {a} {b}");
                let mut at = a;
                for &h in &path.halfedges {
                    assert_eq!(mesh.from(h), at, "{name}");
                    at = mesh.to(h);
                }
                assert_eq!(at, b, "{name}");
                if k == 0 {
                    looked += path.visited;
                    all += exact.order.len();
                }
            }
        }
    }
    assert!(2 * looked < all, "{looked} of {all}");
}

#[test]
fn levels_are_distances_where_each_edge_counts_one() {
    for (name, mesh) in meshes() {
        let ones = EdgeMap::filled(mesh.edge_count(), 1.0);
        let sources = [0, mesh.vertex_count() - 1].map(VertexId::new);
        let exact = dijkstra(&mesh, &ones, &sources, Until::AllReached, Progress::NONE).unwrap();
        let found = breadth_first(&mesh, &sources);
        for v in mesh.vertices() {
            assert_eq!(found.level[v].map(f64::from), Some(exact.distance[v]), "{name} {v}");
            let before = found.arrival[v].map(|h| found.level[mesh.from(h)]);
            assert_eq!(before.flatten(), found.level[v].and_then(|l| l.checked_sub(1)), "{name}");
        }
        assert_eq!(found.order.len(), mesh.vertex_count(), "{name}");
    }
}

#[test]
fn a_search_stops_where_it_is_told_to() {
    let mesh = shapes::icosphere(3).unwrap();
    let lengths = edge_lengths(&mesh);
    let source = VertexId::new(0);
    let search = |until| dijkstra(&mesh, &lengths, &[source], until, Progress::NONE).unwrap();
    let all = search(Until::AllReached);
    let targets: VertexSet = [100, 600].map(VertexId::new).into_iter().collect();
    let last = targets.iter().map(|v| all.distance[v]).fold(0.0, f64::max);
    let first = targets.iter().map(|v| all.distance[v]).fold(f64::INFINITY, f64::min);
    for (until, limit) in [
        (Until::Reached(&targets), last),
        (Until::FirstOf(&targets), first),
        (Until::Distance(0.5), 0.5),
    ] {
        let found = search(until);
        for v in mesh.vertices() {
            // Reached means settled: what is known is right, and nothing beyond the limit is known.
            let is_settled = found.order.contains(&v);
            let expected = if is_settled { all.distance[v] } else { f64::INFINITY };
            assert_eq!(found.distance[v], expected, "{v}");
            assert!(!is_settled || all.distance[v] <= limit, "{v}");
            assert_eq!(found.path(&mesh, v).is_some(), is_settled, "{v}");
        }
        assert_eq!(found.order, all.order[..found.order.len()]);
    }
}

#[test]
fn what_cannot_be_reached_is_infinitely_far() {
    let mesh = shapes::icosphere(1).unwrap();
    let mut lengths = edge_lengths(&mesh);
    let island = VertexId::new(5);
    for e in mesh.vertex_edges(island) {
        lengths[e] = f64::INFINITY;
    }
    let source = VertexId::new(0);
    let found = dijkstra(&mesh, &lengths, &[source], Until::AllReached, Progress::NONE).unwrap();
    assert_eq!(found.path(&mesh, island), None);
    assert_eq!(found.distance.values().iter().filter(|d| d.is_finite()).count(), 41);
    assert_eq!(astar(&mesh, &lengths, source, island, Progress::NONE), Ok(None));
}

#[test]
fn weights_that_are_negative_or_no_numbers_are_refused() {
    let mesh = shapes::cube();
    for bad in [-1.0, f64::NAN, f64::NEG_INFINITY] {
        let mut lengths = edge_lengths(&mesh);
        let edge = mesh.edges().nth(7).unwrap();
        lengths[edge] = bad;
        let source = VertexId::new(0);
        let result = dijkstra(&mesh, &lengths, &[source], Until::AllReached, Progress::NONE);
        assert!(matches!(result, Err(Error::InvalidWeight { edge: e, .. }) if e == edge), "{bad}");
        assert!(astar(&mesh, &lengths, source, source, Progress::NONE).is_err(), "{bad}");
    }
}

#[test]
fn a_search_can_be_cancelled() {
    let stop = |_| std::ops::ControlFlow::Break(());
    let mesh = shapes::cube();
    let (lengths, v) = (edge_lengths(&mesh), VertexId::new(0));
    let result = dijkstra(&mesh, &lengths, &[v], Until::AllReached, Progress::new(&stop));
    assert!(matches!(result, Err(Error::Cancelled(_))));
    let result = astar(&mesh, &lengths, v, VertexId::new(7), Progress::new(&stop));
    assert!(matches!(result, Err(Error::Cancelled(_))));
}
