//! Points in cubes, to be found by where they are.
//!
//! A table of the cubes that are not empty, each the start of a list of points. Nothing is ever asked for all cubes,
//! so that the order of the table reaches no result.

use dgp_mesh::DVec3;

/// No point.
const NONE: u32 = u32::MAX;

/// Points that come one by one.
pub(super) struct Grid {
    /// Cubes per unit of length.
    per_length: f64,
    /// Cubes with the last point that came; a power of two of them.
    table: Vec<([i32; 3], u32)>,
    used: usize,
    points: Vec<DVec3>,
    /// The point of the same cube that came before.
    before: Vec<u32>,
}

impl Grid {
    /// Of cubes with sides of this length; coordinates are below 2³⁰ of them.
    pub(super) fn new(side: f64) -> Self {
        Grid {
            per_length: 1.0 / side,
            table: vec![([0; 3], NONE); 1024],
            used: 0,
            points: Vec::new(),
            before: Vec::new(),
        }
    }

    pub(super) fn points(&self) -> &[DVec3] {
        &self.points
    }

    pub(super) fn add(&mut self, p: DVec3) {
        if 2 * (self.used + 1) > self.table.len() {
            self.grow();
        }
        let cube = self.cube(p);
        let place = find(&self.table, cube);
        let (key, last) = &mut self.table[place];
        if *last == NONE {
            *key = cube;
            self.used += 1;
        }
        self.before.push(*last);
        *last = self.points.len() as u32;
        self.points.push(p);
    }

    /// Whether `f` says so of a point not farther from `p` than a side; perhaps of others that are asked too.
    pub(super) fn any_near(&self, p: DVec3, mut f: impl FnMut(u32, DVec3) -> bool) -> bool {
        let [x, y, z] = self.cube(p);
        for dx in [0, -1, 1] {
            for dy in [0, -1, 1] {
                for dz in [0, -1, 1] {
                    let cube = [x + dx, y + dy, z + dz];
                    let mut i = self.table[find(&self.table, cube)].1;
                    while i != NONE {
                        if f(i, self.points[i as usize]) {
                            return true;
                        }
                        i = self.before[i as usize];
                    }
                }
            }
        }
        false
    }

    fn cube(&self, p: DVec3) -> [i32; 3] {
        (p * self.per_length).floor().to_array().map(|x| x as i32)
    }

    fn grow(&mut self) {
        let mut table = vec![([0; 3], NONE); 2 * self.table.len()];
        for &entry in self.table.iter().filter(|entry| entry.1 != NONE) {
            let place = find(&table, entry.0);
            table[place] = entry;
        }
        self.table = table;
    }
}

/// The place of a cube, or the empty one where it belongs.
fn find(table: &[([i32; 3], u32)], cube: [i32; 3]) -> usize {
    let [x, y, z] = cube.map(|x| u64::from(x as u32));
    let mut hash = x.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    hash = (hash ^ y).rotate_left(29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    hash = (hash ^ z).rotate_left(31).wrapping_mul(0x94d0_49bb_1331_11eb);
    let mut place = (hash >> 32) as usize & (table.len() - 1);
    while table[place].1 != NONE && table[place].0 != cube {
        place = (place + 1) & (table.len() - 1);
    }
    place
}
