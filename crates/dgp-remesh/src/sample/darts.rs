//! Points at least a radius apart, with no room left for another.
//!
//! ```text
//! 1. throw darts anywhere; keep those whose distance to all kept before is at least r
//! 2. of what is left of the surface take a triangle, as likely as its area, and throw a dart into it
//! 3. halve it, leave out what one kept point covers, |corner − point| ≤ r for all corners
//! 4. from 2 on until nothing is left
//! ```
//!
//! - Input: any triangles that have area together. Those without area get no points.
//! - Cost: some 30 looks at a table of cubes for a point, and one for a triangle that is small beside r; one thread,
//!   since each dart depends on those before.
//! - Guarantees: distances are not less than r, exactly as computed from the positions. No point of a triangle
//!   with area is farther than `coverage` from a sample, at most 2⁻¹⁶ r more than r. Distances are those in space: on
//!   both sides of a thin plate only one side has points.
//! - Reference: Cline, Jeschke, White, Razdan and Wonka, "Dart throwing on surfaces", Computer Graphics Forum
//!   28(4), 2009; Dippé and Wold, "Antialiasing through stochastic sampling", SIGGRAPH 1985.
//! - Departs from it: darts at any place first, while many of them hit.

use dgp_mesh::{DVec3, Progress, measure::Surface, shapes::Random};

use super::{
    MAX_SAMPLES, SurfaceSample,
    grid::Grid,
    least_distance,
    triangles::{Triangles, locate},
    uniform::in_triangle,
};
use crate::Error;

/// What [`sample_poisson_disk`] is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PoissonOptions {
    /// Of the random numbers.
    pub seed: u64,
    /// More points are refused: the radius is thought to be in another unit.
    pub max_count: usize,
}

impl Default for PoissonOptions {
    fn default() -> Self {
        PoissonOptions { seed: 0, max_count: MAX_SAMPLES }
    }
}

/// What [`sample_poisson_disk`] did.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct PoissonReport {
    /// The smallest distance between two points; infinite if there are fewer than two.
    pub least_distance: f64,
    /// No point of the surface is farther than this from the nearest sample.
    pub coverage: f64,
    /// Darts thrown, those that missed too.
    pub darts: usize,
}

/// Triangles smaller than this part of the radius are not cut any more.
const FINEST: f64 = 1.0 / (1 << 16) as f64;

/// How often a face is halved at most: beyond, weights of corners are the same numbers.
const DEEPEST: u32 = 90;

/// How many darts at any place are thrown for each expected point between two looks at how many hit.
const VOLLEY: f64 = 0.25;

/// Darts at any place end when fewer than this part of them hit.
const WORTHWHILE: f64 = 0.15;

/// Points of a saturated plane in a square of the radius: Tanemura's 0.547 of the area covered by disks of half
/// the radius.
const SATURATION: f64 = 0.697;

/// Points all over the surface with distances of at least `radius`, until there is no room for another.
///
/// Errors: [`Error::NotTriangle`], [`Error::NotFinite`], [`Error::NoArea`], [`Error::InvalidOption`] for a radius that is
/// not positive or needs more than [`PoissonOptions::max_count`] points, [`Error::Cancelled`].
///
/// ```
/// use dgp_mesh::{Progress, shapes};
/// use dgp_remesh::{PoissonOptions, sample_poisson_disk};
///
/// let sphere = shapes::icosphere(3)?;
/// let (points, report) =
///     sample_poisson_disk(&sphere, 0.2, &PoissonOptions::default(), Progress::NONE)?;
/// assert!(report.least_distance >= 0.2 && report.coverage < 0.20001);
/// assert!((150..350).contains(&points.len()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn sample_poisson_disk(
    surface: &impl Surface,
    radius: f64,
    options: &PoissonOptions,
    progress: Progress<'_>,
) -> Result<(Vec<SurfaceSample>, PoissonReport), Error> {
    let refused = |expected| Error::InvalidOption { name: "radius", value: radius, expected };
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(refused("positive"));
    }
    let triangles = Triangles::new(surface)?;
    // Beyond four units the radius covers the box whatever it is, and squares of it stay numbers.
    let scaled = (radius / triangles.unit).min(8.0);
    let cumulative = triangles.cumulative(0..triangles.len())?;
    let total = cumulative[cumulative.len() - 1];
    let expected = SATURATION * total / (scaled * scaled);
    let crowded = "so large that fewer than `max_count` points have room";
    if scaled < FINEST * FINEST || 0.2 * expected > options.max_count as f64 {
        return Err(refused(crowded));
    }
    let mut throwing = Throwing {
        triangles: &triangles,
        radius: scaled,
        grid: Grid::new(scaled * (1.0 + FINEST)),
        random: Random::new(Random::new(options.seed).bits()),
        samples: Vec::new(),
        darts: 0,
        max_count: options.max_count,
    };
    let is_complete = throwing.anywhere(&cumulative, expected, progress.part(0.0, 0.4))?;
    let beyond = if is_complete { throwing.gaps(progress.part(0.4, 0.9))? } else { None };
    let Some(beyond) = beyond else { return Err(refused(crowded)) };
    let positions: Vec<DVec3> = throwing.samples.iter().map(|sample| sample.position).collect();
    let report = PoissonReport {
        least_distance: least_distance(&positions)?,
        coverage: (scaled + beyond) * triangles.unit,
        darts: throwing.darts,
    };
    progress.report(1.0)?;
    Ok((throwing.samples, report))
}

/// The points so far, and how more are found.
struct Throwing<'a> {
    triangles: &'a Triangles,
    radius: f64,
    grid: Grid,
    random: Random,
    samples: Vec<SurfaceSample>,
    darts: usize,
    max_count: usize,
}

impl Throwing<'_> {
    /// Keeps a dart if it is far from all others; returns whether there is room for one more.
    fn throw(&mut self, f: usize, weights: [f64; 2]) -> bool {
        let p = self.triangles.at(f, weights);
        self.darts += 1;
        if !self.grid.any_near(p, |_, q| p.distance(q) < self.radius) {
            self.grid.add(p);
            self.samples.push(self.triangles.sample(f, weights));
        }
        self.samples.len() <= self.max_count
    }

    /// Step 1. Whether the points were not too many.
    fn anywhere(
        &mut self,
        cumulative: &[f64],
        expected: f64,
        progress: Progress<'_>,
    ) -> Result<bool, Error> {
        let volley = (VOLLEY * expected).ceil().clamp(16.0, 1e6) as usize;
        let total = cumulative[cumulative.len() - 1];
        loop {
            let before = self.samples.len();
            progress.report((before as f64 / expected).min(1.0))?;
            for _ in 0..volley {
                let f = locate(cumulative, self.random.uniform() * total);
                let weights = in_triangle(&mut self.random);
                if !self.throw(f, weights) {
                    return Ok(false);
                }
            }
            if ((self.samples.len() - before) as f64) < WORTHWHILE * volley as f64 {
                return Ok(true);
            }
        }
    }

    /// Steps 2 to 4. By how much the smallest triangles reach beyond the radius; `None` if there are too many points.
    fn gaps(&mut self, progress: Progress<'_>) -> Result<Option<f64>, Error> {
        /// Triangles between two reports.
        const STEP: usize = 1 << 14;
        let mut left = Left::new(self.triangles);
        for f in 0..self.triangles.len() {
            if self.triangles.area(f) > 0.0 {
                self.keep(&mut left, Piece::whole(f));
            }
        }
        let (mut beyond, mut most, mut steps) = (0.0_f64, left.area(), 0_usize);
        while let Some(piece) = left.take(&mut self.random) {
            if steps.is_multiple_of(STEP) {
                most = most.max(left.area());
                progress.report(1.0 - (left.area() / most).min(1.0))?;
            }
            steps += 1;
            let sides = sides(piece.points(self.triangles));
            let size = longest(sides);
            let is_last = size <= FINEST * self.radius || piece.depth == DEEPEST;
            // Of one too small to cut the center is tried: it is covered then, and so is nearly all around.
            let weights = if is_last { [1.0 / 3.0; 2] } else { in_triangle(&mut self.random) };
            if !self.throw(piece.face as usize, piece.at(weights)) {
                return Ok(None);
            }
            if is_last {
                beyond = beyond.max(size);
            } else {
                for half in piece.halves(sides) {
                    self.keep(&mut left, half);
                }
            }
        }
        Ok(Some(beyond))
    }

    /// Step 3: puts a triangle among those left unless a point covers it.
    fn keep(&self, left: &mut Left, piece: Piece) {
        let corners = piece.points(self.triangles);
        // No ball holds a side longer than its diameter.
        if longest(sides(corners)) <= 2.0 * self.radius {
            let center = (corners[0] + corners[1] + corners[2]) / 3.0;
            let covers = |q: DVec3| corners.iter().all(|p| p.distance(q) <= self.radius);
            if self.grid.any_near(center, |_, q| covers(q)) {
                return;
            }
        }
        left.put(piece, 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length());
    }
}

/// The lengths of the sides, each of that from its corner on.
fn sides([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    [a.distance(b), b.distance(c), c.distance(a)]
}

fn longest(sides: [f64; 3]) -> f64 {
    sides.into_iter().fold(0.0, f64::max)
}

/// A part of a face that is left.
#[derive(Clone, Copy, Debug)]
struct Piece {
    face: u32,
    /// How often the face was halved.
    depth: u32,
    /// The weights of its corners.
    corners: [[f64; 2]; 3],
}

impl Piece {
    fn whole(face: usize) -> Self {
        Piece { face: face as u32, depth: 0, corners: [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] }
    }

    /// The weights of the point with these weights of its own corners.
    fn at(&self, [s, t]: [f64; 2]) -> [f64; 2] {
        let [a, b, c] = self.corners;
        [0, 1].map(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]))
    }

    fn points(&self, triangles: &Triangles) -> [DVec3; 3] {
        self.corners.map(|weights| triangles.at(self.face as usize, weights))
    }

    /// Both parts, cut from the middle of the longest side.
    fn halves(&self, sides: [f64; 3]) -> [Piece; 2] {
        let longest = (0..3).fold(0, |k, j| if sides[j] > sides[k] { j } else { k });
        let [a, b, c] = [0, 1, 2].map(|k| self.corners[(longest + k) % 3]);
        let middle = [0, 1].map(|k| 0.5 * (a[k] + b[k]));
        let half = |corners| Piece { face: self.face, depth: self.depth + 1, corners };
        [half([a, middle, c]), half([middle, b, c])]
    }
}

/// The triangles left, by the exponents of their areas.
struct Left {
    /// Areas from 2⁻ᵏ⁻¹ to 2⁻ᵏ of the largest; the last list has all smaller ones.
    lists: Vec<Vec<Piece>>,
    areas: Vec<Vec<f64>>,
    largest: f64,
}

impl Left {
    /// Areas below 2⁻⁵² of the largest are picked as if they were equal.
    const LISTS: usize = 53;

    fn new(triangles: &Triangles) -> Self {
        let largest = (0..triangles.len()).map(|f| triangles.area(f)).fold(0.0, f64::max);
        Left { lists: vec![Vec::new(); Self::LISTS], areas: vec![Vec::new(); Self::LISTS], largest }
    }

    fn put(&mut self, piece: Piece, area: f64) {
        let part = area / self.largest;
        let exponent = 1023 - ((part.to_bits() >> 52) & 0x7ff) as i32 - 1;
        let list = exponent.clamp(0, Self::LISTS as i32 - 1) as usize;
        self.lists[list].push(piece);
        self.areas[list].push(part.min(1.0));
    }

    /// The most area there can be, of the largest triangle.
    fn area(&self) -> f64 {
        self.lists.iter().zip(Self::bounds()).map(|(list, most)| list.len() as f64 * most).sum()
    }

    /// The largest area in each list.
    fn bounds() -> impl Iterator<Item = f64> {
        (0..Self::LISTS as i32).map(|k| 2_f64.powi(-k))
    }

    /// Takes one out, as likely as its area: a list by what it can hold, one of it, and again if that is smaller
    /// than a random number.
    fn take(&mut self, random: &mut Random) -> Option<Piece> {
        loop {
            let whole = self.area();
            if whole == 0.0 {
                return None;
            }
            let mut x = random.uniform() * whole;
            let mut chosen = None;
            for (k, most) in Self::bounds().enumerate().filter(|&(k, _)| !self.lists[k].is_empty())
            {
                chosen = Some((k, most));
                x -= self.lists[k].len() as f64 * most;
                if x < 0.0 {
                    break;
                }
            }
            let (k, most) = chosen?;
            let i = random.below(self.lists[k].len());
            if k + 1 == Self::LISTS || random.uniform() * most <= self.areas[k][i] {
                self.areas[k].swap_remove(i);
                return Some(self.lists[k].swap_remove(i));
            }
        }
    }
}
