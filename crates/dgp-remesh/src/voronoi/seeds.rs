//! The first clusters: vertices far from each other, and what is nearest to each along edges.

use dgp_mesh::{
    DVec3, Progress, VertexId, graph::IndexedHeap, shapes::Random, topology::components,
};

use super::{VoronoiOptions, refine::Fine};
use crate::{
    Error,
    sample::{BlueNoiseOptions, curve_order, eliminate, locate},
};

/// Vertices from which each seed is chosen.
const CANDIDATES: usize = 5;

/// For each vertex the number of its cluster; `u32::MAX` on no face.
pub(super) fn seeds(
    fine: &Fine,
    count: usize,
    options: &VoronoiOptions,
    progress: Progress<'_>,
) -> Result<Vec<u32>, Error> {
    let mut chosen = spread(fine, count, options, progress.part(0.0, 0.6))?;
    let parts = components(&fine.mesh);
    let mut has_seed = vec![false; parts.count];
    for &v in &chosen {
        if let Some(c) = parts.vertex[v] {
            has_seed[c as usize] = true;
        }
    }
    for (v, part) in parts.vertex.iter() {
        if let Some(c) = part
            && !std::mem::replace(&mut has_seed[*c as usize], true)
        {
            chosen.push(v);
        }
    }
    grow(fine, &chosen, progress.part(0.6, 1.0))
}

/// `count` vertices, dense as the density wants, fewer if there are no more.
fn spread(
    fine: &Fine,
    count: usize,
    options: &VoronoiOptions,
    progress: Progress<'_>,
) -> Result<Vec<VertexId>, Error> {
    let mesh = &fine.mesh;
    let used: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_isolated_vertex(v)).collect();
    if count >= used.len() {
        return Ok(used);
    }
    let points: Vec<DVec3> = used.iter().map(|&v| mesh.position(v)).collect();
    let order = curve_order(&points);
    let mut sum = 0.0;
    let sums = order.iter().map(|&i| {
        let v = used[i as usize].index();
        sum += fine.areas[v] * fine.density[v].sqrt();
        sum
    });
    let sums: Vec<f64> = sums.collect();
    progress.report(0.3)?;
    let is_even = options.gradation == 0.0;
    let wanted = if is_even { (CANDIDATES * count).min(used.len()) } else { count };
    let mut random = Random::new(Random::new(options.seed).bits());
    let mut is_chosen = vec![false; used.len()];
    for i in 0..wanted {
        let x = (i as f64 + random.uniform()) / wanted as f64 * sum;
        is_chosen[order[locate(&sums, x)] as usize] = true;
    }
    // Where a vertex was met twice, another is missing.
    let mut missing = count.saturating_sub(is_chosen.iter().filter(|&&is| is).count());
    let step = used.len() / count;
    for k in (0..step).flat_map(|first| (first..used.len()).step_by(step)) {
        if missing == 0 {
            break;
        }
        missing -= usize::from(!std::mem::replace(&mut is_chosen[order[k] as usize], true));
    }
    let candidates = order.into_iter().filter(|&i| is_chosen[i as usize]);
    let candidates: Vec<VertexId> = candidates.map(|i| used[i as usize]).collect();
    if !is_even {
        return Ok(candidates);
    }
    let points: Vec<DVec3> = candidates.iter().map(|&v| mesh.position(v)).collect();
    let noise = BlueNoiseOptions::default();
    let kept = eliminate(&points, count, sum, &noise, progress.part(0.4, 1.0))?;
    Ok(kept.into_iter().map(|i| candidates[i as usize]).collect())
}

/// To which seed each vertex is nearest along edges, which are longer where the density is high.
fn grow(fine: &Fine, seeds: &[VertexId], progress: Progress<'_>) -> Result<Vec<u32>, Error> {
    /// Vertices between two reports.
    const STEP: usize = 1 << 16;
    let mesh = &fine.mesh;
    let mut labels = vec![u32::MAX; mesh.vertex_count()];
    let mut is_settled = vec![false; mesh.vertex_count()];
    let mut heap = IndexedHeap::with_capacity(mesh.vertex_count());
    for (i, &v) in seeds.iter().enumerate() {
        labels[v.index()] = i as u32;
        heap.set(v, 0.0);
    }
    let mut done = 0_usize;
    while let Some((v, distance)) = heap.pop() {
        if done.is_multiple_of(STEP) {
            progress.report(done as f64 / mesh.vertex_count() as f64)?;
        }
        done += 1;
        is_settled[v.index()] = true;
        for w in mesh.vertex_neighbors(v).filter(|w| !is_settled[w.index()]) {
            let density = 0.5 * (fine.density[v.index()] + fine.density[w.index()]);
            let length = mesh.position(v).distance(mesh.position(w)) * density.sqrt().sqrt();
            let there = distance + length;
            if heap.key(w).is_none_or(|known| there < known) {
                heap.set(w, there);
                labels[w.index()] = labels[v.index()];
            }
        }
    }
    Ok(labels)
}
