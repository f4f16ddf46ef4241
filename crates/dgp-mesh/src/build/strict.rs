//! The strict build: a mesh, or everything that is in the way.

use crate::{Error, IndexedFaceSet, Mesh, Progress, defects};

/// Makes a mesh of `set` if it is an oriented manifold, as [`Mesh::new`] does, but tells all that is
/// in the way otherwise and not only the first obstacle.
///
/// Errors: [`Error::Defective`] with every defect and the elements that have it,
/// [`Error::Cancelled`].
///
/// ```
/// use dgp_mesh::{DVec3, DefectKind, Error, FaceList, IndexedFaceSet, Progress, strict_mesh};
///
/// let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let faces = FaceList::from_indices(&[[0, 1, 1], [0, 1, 2], [1, 2, 3]]);
/// let Err(Error::Defective(report)) =
///     strict_mesh(&IndexedFaceSet::new(positions, faces)?, Progress::NONE)
/// else {
///     panic!("a face names a vertex twice, and two disagree");
/// };
/// assert_eq!(report.count(DefectKind::RepeatedVertex), 1);
/// assert_eq!(report.count(DefectKind::MisorientedEdge), 1);
/// # Ok::<(), dgp_mesh::Error>(())
/// ```
pub fn strict_mesh(set: &IndexedFaceSet, progress: Progress<'_>) -> Result<Mesh, Error> {
    progress.report(0.0)?;
    match Mesh::new(set) {
        Err(Error::NotManifold(_)) => {
            Err(Error::Defective(Box::new(defects(set, progress.part(0.1, 1.0))?)))
        }
        other => other,
    }
}
