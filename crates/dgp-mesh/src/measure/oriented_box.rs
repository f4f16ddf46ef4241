//! A tight box in any orientation.
//!
//! ```text
//! start    along the coordinate axes, along the principal axes of the vertices,
//!          and along the largest face
//! repeat   for each axis of the box: project along it and turn the box about it so that the
//!          rectangle around the projection is smallest (rotating calipers)
//! until    no turn makes the box smaller; of the three boxes keep the smallest
//! ```
//!
//! - Input: any vertices.
//! - Cost: O(V log V) a turn, tens of turns; usually O(V).
//! - Guarantees: all vertices are inside but for rounding. No turn about one of its own axes makes the box smaller,
//!   and it is no larger than the box along the coordinate axes. It is not always the smallest of all.
//! - Reference: Toussaint, "Solving geometric problems with the rotating calipers", MELECON 1983;
//!   O'Rourke, "Finding minimal enclosing boxes", International Journal of Computer and Information
//!   Sciences 14, 1985 (the smallest box, in cubic time).

use glam::{DMat3, DVec2, DVec3};

use super::{
    Surface, bounding_box,
    face::{local_vector_area, normal},
    frame::Frame,
    scale,
};
use crate::{FaceMap, linear::symmetric_eigen, parallel};

/// A box in any orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// The point in the middle.
    pub center: DVec3,
    /// The unit directions of the sides as columns, a right-handed frame, longest side first.
    pub axes: DMat3,
    /// The lengths of the sides.
    pub size: DVec3,
}

impl OrientedBox {
    /// The product of the sides.
    pub fn volume(&self) -> f64 {
        self.size.x * self.size.y * self.size.z
    }

    /// The eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let side = |bit: usize| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
            self.center + self.axes * (DVec3::new(side(0), side(1), side(2)) * self.size)
        })
    }
}

/// A tight box around all vertices, those of no face included; `None` if there are none.
///
/// Vertices with a coordinate that is not finite do not count.
pub fn oriented_box(surface: &impl Surface) -> Option<OrientedBox> {
    bounding_box(surface)?;
    let frame = Frame::of(surface);
    let positions = surface.vertex_positions().values();
    let points: Vec<DVec3> =
        positions.iter().filter(|p| p.is_finite()).map(|&p| frame.local(p)).collect();
    let starts = [DMat3::IDENTITY, principal_axes(&points), axes_of_largest_face(surface, &frame)];
    let axes = starts
        .into_iter()
        .map(|start| turn_until_tight(&points, start))
        // Of equal boxes the first, so that a box along the coordinate axes stays so.
        .min_by(|a, b| cost(&points, *a).total_cmp(&cost(&points, *b)))?;
    let axes = longest_first(&points, axes);
    let (low, high) = extent(&points, axes);
    Some(OrientedBox {
        center: frame.global(axes * (0.5 * (low + high))),
        axes,
        size: (high - low).map(|x| frame.measure(x, 1)),
    })
}

/// The same box with its longest side first.
fn longest_first(points: &[DVec3], axes: DMat3) -> DMat3 {
    let (low, high) = extent(points, axes);
    let size = high - low;
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| size[j].total_cmp(&size[i]));
    let [x, y] = [order[0], order[1]].map(|k| axes.col(k));
    let z = axes.col(order[2]);
    DMat3::from_cols(x, y, if x.cross(y).dot(z) > 0.0 { z } else { -z })
}

/// What is to become small: the volume, or the area if the box is flat, or the length.
fn cost(points: &[DVec3], axes: DMat3) -> f64 {
    let (low, high) = extent(points, axes);
    let size = high - low;
    // Sides below rounding count as that, else their noise would decide.
    let floor = 16.0 * f64::EPSILON;
    size.x.max(floor) * size.y.max(floor) * size.z.max(floor)
}

/// The smallest and largest coordinates along `axes`.
fn extent(points: &[DVec3], axes: DMat3) -> (DVec3, DVec3) {
    let to_box = axes.transpose();
    let nothing = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
    let blocks = parallel::map_blocks(points.len(), parallel::BLOCK, |range| {
        points[range].iter().fold(nothing, |(low, high), &p| {
            let q = to_box * p;
            (low.min(q), high.max(q))
        })
    });
    blocks.into_iter().fold(nothing, |(low, high), (l, h)| (low.min(l), high.max(h)))
}

/// The eigenvectors of the covariance of `points`.
fn principal_axes(points: &[DVec3]) -> DMat3 {
    let blocks = parallel::map_blocks(points.len(), parallel::BLOCK, |range| {
        points[range].iter().fold((DVec3::ZERO, DMat3::ZERO), |(sum, squares), &p| {
            (sum + p, squares + DMat3::from_cols(p * p.x, p * p.y, p * p.z))
        })
    });
    let (sum, squares) =
        blocks.into_iter().fold((DVec3::ZERO, DMat3::ZERO), |(p, a), (q, b)| (p + q, a + b));
    let mean = sum / points.len() as f64;
    let spread = squares - DMat3::from_cols(sum * mean.x, sum * mean.y, sum * mean.z);
    symmetric_eigen(&spread).vectors
}

/// The normal of the face of largest area, its longest side and what is perpendicular to both.
fn axes_of_largest_face(surface: &impl Surface, frame: &Frame) -> DMat3 {
    let areas: FaceMap<f64> =
        parallel::map(surface.number_of_faces(), |f| local_vector_area(surface, frame, f).length());
    let largest = areas.iter().filter(|(_, area)| area.is_finite()).fold(
        None,
        |best, (f, &area)| match best {
            Some((_, most)) if most >= area => best,
            _ => Some((f, area)),
        },
    );
    let Some((f, _)) = largest else { return DMat3::IDENTITY };
    let positions = surface.vertex_positions();
    let corners: Vec<DVec3> = surface.polygon(f).map(|v| positions[v]).collect();
    let after = corners.iter().cycle().skip(1);
    let sides = corners.iter().zip(after).map(|(&a, &b)| scale::half_side(a, b));
    let longest = sides.fold(DVec3::ZERO, |longest, side| {
        if scale::length(side) > scale::length(longest) { side } else { longest }
    });
    let x = scale::unit(longest);
    let y = scale::unit(normal(surface, f).cross(x));
    if x == DVec3::ZERO || y == DVec3::ZERO {
        return DMat3::IDENTITY;
    }
    DMat3::from_cols(x, y, x.cross(y))
}

/// Turns the box about its axes as long as that makes it smaller.
fn turn_until_tight(points: &[DVec3], mut axes: DMat3) -> DMat3 {
    // Each turn multiplies the rectangle by less than 1 − GAIN, so this ends; ten turns are typical.
    const GAIN: f64 = 1e-9;
    const TURNS: usize = 60;
    let mut tight_in_a_row = 0;
    for turn in 0..TURNS {
        let [x, y] = [(turn + 1) % 3, (turn + 2) % 3].map(|k| axes.col(k));
        let flat: Vec<DVec2> = points.iter().map(|p| DVec2::new(p.dot(x), p.dot(y))).collect();
        let (area_before, area, direction) = smallest_rectangle(flat);
        if area < area_before * (1.0 - GAIN) {
            let new_x = (x * direction.x + y * direction.y).normalize();
            let z = axes.col(turn % 3);
            let mut columns = [DVec3::ZERO; 3];
            columns[turn % 3] = z;
            columns[(turn + 1) % 3] = new_x;
            columns[(turn + 2) % 3] = z.cross(new_x).normalize();
            axes = DMat3::from_cols_array_2d(&columns.map(|c| c.to_array()));
            tight_in_a_row = 1;
        } else {
            tight_in_a_row += 1;
        }
        if tight_in_a_row >= 3 {
            break;
        }
    }
    axes
}

/// The area of the rectangle along the axes, that of the smallest rectangle, and the direction of one
/// of its sides.
fn smallest_rectangle(points: Vec<DVec2>) -> (f64, f64, DVec2) {
    let hull = convex_hull(points);
    let along = |x: DVec2, y: DVec2| {
        let range = |axis: DVec2| {
            let values = hull.iter().map(|p| p.dot(axis));
            let (low, high) =
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), t| (l.min(t), h.max(t)));
            high - low
        };
        range(x) * range(y)
    };
    let before = along(DVec2::X, DVec2::Y);
    if hull.len() < 3 {
        // On a line: along it.
        let direction = match *hull {
            [a, b] => (b - a).normalize_or(DVec2::X),
            _ => DVec2::X,
        };
        return (before, 0.0, direction);
    }
    // The smallest rectangle has a side along the hull; the farthest points only move forward.
    let n = hull.len();
    let (mut right, mut top, mut left) = (1, 1, 1);
    let mut best = (before, DVec2::X);
    for i in 0..n {
        let side = hull[(i + 1) % n] - hull[i];
        let Some(x) = side.try_normalize() else { continue };
        let y = x.perp();
        let farther = |k: usize, axis: DVec2| hull[(k + 1) % n].dot(axis) > hull[k % n].dot(axis);
        right = right.max(i + 1);
        while right < i + n && farther(right, x) {
            right += 1;
        }
        top = top.max(right);
        while top < i + n && farther(top, y) {
            top += 1;
        }
        left = left.max(top);
        while left < i + n && farther(left, -x) {
            left += 1;
        }
        let width = hull[right % n].dot(x) - hull[left % n].dot(x);
        let height = hull[top % n].dot(y) - hull[i].dot(y);
        if width * height < best.0 {
            best = (width * height, x);
        }
    }
    (before, best.0, best.1)
}

/// The corners of the convex hull, counterclockwise (Andrew 1979).
fn convex_hull(points: Vec<DVec2>) -> Vec<DVec2> {
    let mut points = without_inner_points(points);
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut hull: Vec<DVec2> = Vec::new();
    let half = |hull: &mut Vec<DVec2>, points: &mut dyn Iterator<Item = DVec2>| {
        let start = hull.len();
        for p in points {
            while let [.., a, b] = hull[start..]
                && (b - a).perp_dot(p - a) <= 0.0
            {
                hull.pop();
            }
            hull.push(p);
        }
        hull.pop();
    };
    half(&mut hull, &mut points.iter().copied());
    half(&mut hull, &mut points.iter().rev().copied());
    hull
}

/// Drops what lies inside the polygon of the extreme points in eight directions: nearly everything
/// (Akl and Toussaint 1978).
fn without_inner_points(points: Vec<DVec2>) -> Vec<DVec2> {
    const DIRECTIONS: [DVec2; 8] = [
        DVec2::new(1.0, 0.0),
        DVec2::new(1.0, 1.0),
        DVec2::new(0.0, 1.0),
        DVec2::new(-1.0, 1.0),
        DVec2::new(-1.0, 0.0),
        DVec2::new(-1.0, -1.0),
        DVec2::new(0.0, -1.0),
        DVec2::new(1.0, -1.0),
    ];
    let Some(&first) = points.first() else { return points };
    let corners = points.iter().fold([first; 8], |mut best, &p| {
        for (corner, direction) in best.iter_mut().zip(DIRECTIONS) {
            if p.dot(direction) > corner.dot(direction) {
                *corner = p;
            }
        }
        best
    });
    let sides: Vec<(DVec2, DVec2)> =
        (0..8).map(|i| (corners[i], corners[(i + 1) % 8] - corners[i])).collect();
    let is_inside =
        |p: DVec2| sides.iter().all(|&(a, side)| side == DVec2::ZERO || side.perp_dot(p - a) > 0.0);
    points.into_iter().filter(|&p| !is_inside(p)).collect()
}
