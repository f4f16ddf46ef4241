//! Nearest points: a balanced k-d tree.
//!
//! - Input: finite points, repeated ones and grids included.
//! - Cost: O(n log n) to build, O(k log n) for k neighbors of points spread over a surface.
//! - Guarantees: of equally distant points those of smaller number come first, so that the answer
//!   does not depend on the tree.
//! - Reference: Friedman, Bentley and Finkel, "An algorithm for finding best matches in logarithmic
//!   expected time", ACM Transactions on Mathematical Software 3(3), 1977.

use std::{collections::BinaryHeap, ops::Range};

use dgp_mesh::{DVec3, VertexId};

use crate::Error;

/// Points per leaf: below this a plain loop is faster than a descent.
const LEAF: usize = 12;

/// Finds neighbors among points.
pub(crate) struct Nearest<'a> {
    points: &'a [DVec3],
    /// The numbers of the points; the middle one of each range splits it.
    order: Vec<u32>,
    /// The axis along which the point in this place splits its range.
    axes: Vec<u8>,
}

/// A squared distance by its bits, which are ordered as it is, and the number of the point.
type Found = (u64, u32);

impl<'a> Nearest<'a> {
    /// Errors: [`Error::NotFinite`].
    pub(crate) fn new(points: &'a [DVec3]) -> Result<Self, Error> {
        if let Some(bad) = points.iter().position(|p| !p.is_finite()) {
            return Err(Error::NotFinite { vertex: VertexId::new(bad) });
        }
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let mut axes = vec![0; points.len()];
        split(points, &mut order, &mut axes);
        Ok(Nearest { points, order, axes })
    }

    /// The numbers of the `count` points nearest to point `i`, itself left out, nearest first.
    pub(crate) fn neighbors(&self, i: usize, count: usize) -> Vec<u32> {
        let mut best = BinaryHeap::with_capacity(count + 1);
        if count == 0 {
            return Vec::new();
        }
        self.search(0..self.order.len(), i, &mut |found: Found| {
            best.push(found);
            if best.len() > count {
                best.pop();
            }
            if best.len() < count {
                u64::MAX
            } else {
                best.peek().map_or(0, |worst: &Found| worst.0)
            }
        });
        best.into_sorted_vec().into_iter().map(|found| found.1).collect()
    }

    /// The numbers of the points with a squared distance from point `i` of at most `square`, itself left
    /// out, in order of their numbers.
    pub(crate) fn within(&self, i: usize, square: f64) -> Vec<u32> {
        let limit = square.to_bits();
        let mut found = Vec::new();
        self.search(0..self.order.len(), i, &mut |(distance, j): Found| {
            if distance <= limit {
                found.push(j);
            }
            limit
        });
        found.sort_unstable();
        found
    }

    /// Offers points near point `i` to `take`, which returns beyond which distance none is wanted. The
    /// last such answer, or any where nothing was offered.
    fn search(&self, range: Range<usize>, i: usize, take: &mut impl FnMut(Found) -> u64) -> u64 {
        let center = self.points[i];
        let mut limit = u64::MAX;
        if range.len() <= LEAF {
            for &j in &self.order[range] {
                if j as usize != i {
                    let distance = self.points[j as usize].distance_squared(center);
                    limit = take((distance.to_bits(), j));
                }
            }
            return limit;
        }
        let middle = usize::midpoint(range.start, range.end);
        let (j, axis) = (self.order[middle], self.axes[middle] as usize);
        let split = self.points[j as usize];
        let across = center[axis] - split[axis];
        let (low, high) = (range.start..middle, middle + 1..range.end);
        let (near, far) = if across < 0.0 { (low, high) } else { (high, low) };
        limit = limit.min(self.search(near, i, take));
        if j as usize != i {
            limit = limit.min(take((split.distance_squared(center).to_bits(), j)));
        }
        // Equal distances are looked at too: the smaller number wins.
        if (across * across).to_bits() <= limit {
            limit = limit.min(self.search(far, i, take));
        }
        limit
    }
}

/// Orders a range so that its middle point splits it, and each half likewise.
fn split(points: &[DVec3], range: &mut [u32], axes: &mut [u8]) {
    if range.len() <= LEAF {
        return;
    }
    let start = points[range[0] as usize];
    let (low, high) = range.iter().fold((start, start), |(low, high), &i| {
        (low.min(points[i as usize]), high.max(points[i as usize]))
    });
    let axis = (high - low).max_position();
    let middle = range.len() / 2;
    range.select_nth_unstable_by(middle, |&i, &j| {
        points[i as usize][axis].total_cmp(&points[j as usize][axis]).then(i.cmp(&j))
    });
    axes[middle] = axis as u8;
    let ((low, high), (low_axes, high_axes)) =
        (range.split_at_mut(middle), axes.split_at_mut(middle));
    split(points, low, low_axes);
    split(points, &mut high[1..], &mut high_axes[1..]);
}

#[cfg(test)]
mod tests {
    use dgp_mesh::shapes::Random;

    use super::*;

    fn brute(points: &[DVec3], i: usize) -> Vec<Found> {
        let others = (0..points.len()).filter(|&j| j != i);
        let mut all: Vec<Found> =
            others.map(|j| (points[j].distance_squared(points[i]).to_bits(), j as u32)).collect();
        all.sort_unstable();
        all
    }

    #[test]
    fn neighbors_are_those_of_all_pairs_on_grids_and_repeated_points_too() {
        let mut random = Random::new(4);
        let mut point = || DVec3::new(random.uniform(), random.uniform(), random.uniform());
        let clouds = [
            (0..300).map(|_| point()).collect::<Vec<_>>(),
            (0..343)
                .map(|i| DVec3::new((i % 7) as f64, (i / 7 % 7) as f64, (i / 49) as f64))
                .collect(),
            (0..100).map(|i| DVec3::splat(f64::from(i % 3))).collect(),
            vec![DVec3::ONE; 50],
            vec![DVec3::X],
        ];
        for points in clouds {
            let tree = Nearest::new(&points).unwrap();
            for i in 0..points.len() {
                let expected = brute(&points, i);
                for count in [0, 1, 8, 400] {
                    let first: Vec<u32> =
                        expected.iter().take(count).map(|found| found.1).collect();
                    assert_eq!(tree.neighbors(i, count), first, "point {i}, {count} neighbors");
                }
                let near = expected.iter().filter(|found| found.0 <= 0.5_f64.to_bits());
                let mut near: Vec<u32> = near.map(|found| found.1).collect();
                near.sort_unstable();
                assert_eq!(tree.within(i, 0.5), near, "point {i}");
            }
        }
    }

    #[test]
    fn points_that_are_no_numbers_are_refused() {
        let points = [DVec3::ZERO, DVec3::new(0.0, f64::NAN, 0.0)];
        assert!(
            matches!(Nearest::new(&points), Err(Error::NotFinite { vertex }) if vertex.index() == 1)
        );
    }
}
