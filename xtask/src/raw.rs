//! Raw meshes: what all drivers start from, so that every program sees the same bits.
//!
//! Three 64-bit counts (vertices, faces, corners), coordinates as doubles, the start of each face and
//! one end, and the vertex of each corner as 32-bit integers; all little-endian.

use std::{fs, path::Path};

use dgp_mesh::{DVec3, FaceId, FaceList, IndexedFaceSet, VertexId};

use crate::shell::Outcome;

/// Writes `set` without its attributes.
pub(crate) fn write(path: &Path, set: &IndexedFaceSet) -> Outcome<()> {
    let corners = set.faces().corners();
    let counts = [set.vertex_count(), set.face_count(), corners.len()];
    let mut bytes = Vec::with_capacity(28 + 24 * counts[0] + 4 * counts[1] + 4 * counts[2]);
    bytes.extend(counts.iter().flat_map(|&count| (count as u64).to_le_bytes()));
    bytes.extend(
        set.positions().values().iter().flat_map(DVec3::to_array).flat_map(f64::to_le_bytes),
    );
    let mut start = 0_u32;
    bytes.extend(start.to_le_bytes());
    for (_, face) in set.faces().iter() {
        start += face.len() as u32;
        bytes.extend(start.to_le_bytes());
    }
    bytes.extend(corners.iter().flat_map(|v| (v.index() as u32).to_le_bytes()));
    fs::write(path, bytes).map_err(|error| format!("{}: {error}", path.display()).into())
}

/// Reads what [`write()`] or a reference driver wrote.
pub(crate) fn read(path: &Path) -> Outcome<IndexedFaceSet> {
    let bytes = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    parse(&bytes).ok_or_else(|| format!("{}: truncated", path.display()))?
}

fn parse(bytes: &[u8]) -> Option<Outcome<IndexedFaceSet>> {
    let (counts, rest) = bytes.split_at_checked(24)?;
    let [vertices, faces, corners] = [0, 8, 16]
        .map(|at| u64::from_le_bytes(counts[at..at + 8].try_into().expect("8 bytes")) as usize);
    let (positions, rest) = rest.split_at_checked(24 * vertices)?;
    let (starts, rest) = rest.split_at_checked(4 * (faces + 1))?;
    let (corners, _) = rest.split_at_checked(4 * corners)?;
    // Nothing is made and freed again, so that what a mesh built from this holds can be measured.
    let mut coordinates = numbers(positions);
    let positions: Vec<DVec3> = (0..vertices)
        .map(|_| DVec3::from_array([(); 3].map(|()| coordinates.next().expect("24 bytes each"))))
        .collect();
    let corners: Vec<VertexId> = integers(corners).map(VertexId::new).collect();
    let faces = integers(starts).zip(integers(starts).skip(1));
    let list = if faces.clone().all(|(start, end)| end - start == 3) {
        FaceList::from_corners(corners, 3)
    } else {
        let mut list = FaceList::new();
        for (start, end) in faces {
            list.push(corners.get(start..end)?);
        }
        list
    };
    Some(IndexedFaceSet::new(positions, list).map_err(Into::into))
}

/// Little-endian doubles.
pub(crate) fn doubles(bytes: &[u8]) -> Vec<f64> {
    numbers(bytes).collect()
}

fn numbers(bytes: &[u8]) -> impl Iterator<Item = f64> + '_ {
    bytes.as_chunks::<8>().0.iter().map(|&chunk| f64::from_le_bytes(chunk))
}

fn integers(bytes: &[u8]) -> impl Iterator<Item = usize> + Clone + '_ {
    bytes.as_chunks::<4>().0.iter().map(|&chunk| u32::from_le_bytes(chunk) as usize)
}

/// The faces of `set` as plain indices.
pub(crate) fn faces(set: &IndexedFaceSet) -> Vec<Vec<usize>> {
    let ids = (0..set.face_count()).map(FaceId::new);
    ids.map(|f| set.faces().face(f).iter().map(|v| v.index()).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn raw_meshes_come_back_as_they_went_in() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
        let list = FaceList::from_indices::<&[usize]>(&[&[0, 1, 2], &[0, 1, 3, 2]]);
        let set = IndexedFaceSet::new(positions, list).unwrap();
        let folder = std::env::temp_dir().join(format!("xtask-raw-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("quad.raw");
        write(&path, &set).unwrap();
        assert_eq!(read(&path).unwrap(), set);
        fs::write(&path, &fs::read(&path).unwrap()[..50]).unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("truncated"));
        fs::remove_dir_all(&folder).unwrap();
    }
}
