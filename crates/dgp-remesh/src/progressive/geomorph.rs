//! Geomorphs: a level flows into a finer one without a jump.

use dgp_mesh::DVec3;

use super::ProgressiveMesh;
use crate::Error;

/// The faces of a level, whose vertices move from where they are at a coarser one.
///
/// ```
/// use dgp_mesh::{Progress, shapes};
/// use dgp_remesh::{ProgressiveMesh, QuadricOptions, Target};
///
/// let mesh = shapes::icosphere(2)?;
/// let options = QuadricOptions::default();
/// let mut levels = ProgressiveMesh::new(&mesh, Target::Faces(20), &options, Progress::NONE)?;
/// let morph = levels.geomorph(10, 60)?;
/// assert_eq!(levels.level(), 60);
/// assert_eq!(morph.positions(1.0), levels.positions());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Geomorph {
    coarse: Vec<DVec3>,
    fine: Vec<DVec3>,
}

impl Geomorph {
    /// Where the vertices of the finer level are at `t`: 0 looks as the coarser level does, 1 is the finer one.
    pub fn positions(&self, t: f64) -> Vec<DVec3> {
        let between = |(&p, &q): (&DVec3, &DVec3)| if t == 1.0 { q } else { p + (q - p) * t };
        self.coarse.iter().zip(&self.fine).map(between).collect()
    }
}

impl ProgressiveMesh {
    /// How level `from` becomes level `to`, a finer one, which is the present level afterwards.
    ///
    /// Errors: [`Error::NoLevel`]; [`Error::InvalidOption`] if `to` is coarser.
    pub fn geomorph(&mut self, from: usize, to: usize) -> Result<Geomorph, Error> {
        if to < from {
            let expected = "a level that is no finer than the other";
            return Err(Error::InvalidOption { name: "from", value: from as f64, expected });
        }
        self.set_level(to)?;
        let fine = self.positions().to_vec();
        self.set_level(from)?;
        let mut coarse = self.positions().to_vec();
        // A vertex that comes starts where the one that it is split from does.
        for split in &self.splits[from..to] {
            let start = coarse[split.vertex as usize];
            coarse.push(start);
        }
        self.set_level(to)?;
        Ok(Geomorph { coarse, fine })
    }
}
