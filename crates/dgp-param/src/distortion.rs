//! What a map to the plane does to lengths, angles and areas.
//!
//! ```text
//! J = D_s D_m⁻¹ = U diag(σ₁, σ₂) Vᵀ      D_m, D_s: two sides of a triangle in its own plane and in the picture
//!
//! conformal ½ (σ₁/σ₂ + σ₂/σ₁)       areal ½ (det + 1/det)       isometric α conformal + (1 − α) areal
//! symmetric Dirichlet σ₁² + σ₂² + σ₁⁻² + σ₂⁻²
//! stretch, of the way back: L² = √(½ (σ₁⁻² + σ₂⁻²)),  L∞ = 1/σ₂
//! ```
//!
//! det is negative where a face is turned over. All of them are 1 (symmetric Dirichlet: 4) for isometries.
//!
//! - Input: triangles with area, and a place in the plane for each vertex.
//! - Cost: O(F).
//! - Reference: Hormann and Greiner, "MIPS: an efficient global parametrization method", 2000; Sander, Snyder,
//!   Gortler and Hoppe, "Texture mapping progressive meshes", 2001; Smith and Schaefer, "Bijective
//!   parameterization with free boundaries", 2015.

use dgp_mesh::{DVec2, FaceId, FaceMap, Mesh, VertexMap, measure::require_triangles};

use crate::Error;

/// What a map does to a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaceDistortion {
    /// By how much lengths grow in the direction in which they grow most.
    pub largest: f64,
    /// The same where they grow least; negative if the face is turned over.
    pub smallest: f64,
}

impl FaceDistortion {
    /// That of the triangle with corners `space`, in any plane coordinates, mapped to `plane`.
    fn new(sides: [DVec2; 2], pictures: [DVec2; 2]) -> Self {
        let [a, b] = sides;
        let area = a.perp_dot(b);
        // J = pictures · sides⁻¹, by columns.
        let x = (pictures[0] * b.y - pictures[1] * a.y) / area;
        let y = (pictures[1] * a.x - pictures[0] * b.x) / area;
        // Sum and difference of the singular values, the smaller with the sign of the determinant.
        let sum = DVec2::new(x.x + y.y, x.y - y.x).length();
        let difference = DVec2::new(x.x - y.y, x.y + y.x).length();
        FaceDistortion { largest: 0.5 * (sum + difference), smallest: 0.5 * (sum - difference) }
    }

    /// Area of the picture by area of the face; negative if it is turned over.
    pub fn area_ratio(&self) -> f64 {
        self.largest * self.smallest
    }

    /// ½ (σ₁/σ₂ + σ₂/σ₁): 1 where angles are kept; at most −1 where the face is turned over.
    pub fn conformal(&self) -> f64 {
        let ratio = self.largest / self.smallest;
        0.5 * (ratio + 1.0 / ratio)
    }

    /// ½ (det + 1/det): 1 where areas are kept; at most −1 where the face is turned over.
    pub fn areal(&self) -> f64 {
        let ratio = self.area_ratio();
        0.5 * (ratio + 1.0 / ratio)
    }

    /// `alpha` of the conformal and the rest of the areal distortion.
    pub fn isometric(&self, alpha: f64) -> f64 {
        alpha * self.conformal() + (1.0 - alpha) * self.areal()
    }

    /// σ₁² + σ₂² + σ₁⁻² + σ₂⁻²: 4 for isometries; infinite where the face is turned over, which no map that
    /// is led by this energy ever does.
    pub fn symmetric_dirichlet(&self) -> f64 {
        if self.smallest <= 0.0 {
            return f64::INFINITY;
        }
        let squares = [self.largest, self.smallest].map(|sigma| sigma * sigma);
        squares.iter().map(|square| square + 1.0 / square).sum()
    }

    /// √(½ (σ₁⁻² + σ₂⁻²)): by how much a texture is stretched on the surface, root of the mean square.
    pub fn stretch(&self) -> f64 {
        (0.5 * (self.largest.powi(-2) + self.smallest.powi(-2))).sqrt()
    }

    /// 1/σ₂: the most by which a texture is stretched on the surface.
    pub fn largest_stretch(&self) -> f64 {
        1.0 / self.smallest.abs()
    }
}

/// The least, the largest, and the mean by area of a measure of distortion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// The least.
    pub min: f64,
    /// The mean, faces counting by their area on the surface.
    pub mean: f64,
    /// The largest.
    pub max: f64,
}

/// What a map does to a surface. Faces that are turned over or without area in the picture are counted and left
/// out of the rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DistortionReport {
    /// Faces that are turned over.
    pub flipped: usize,
    /// Faces whose picture has no area.
    pub flat: usize,
    /// Area of the surface.
    pub area: f64,
    /// Area of the picture, faces that are turned over counting as negative.
    pub mapped_area: f64,
    /// Distortion of angles; 1 where they are kept.
    pub conformal: Spread,
    /// Distortion of areas once the picture is scaled to the area of the surface; 1 where they are kept.
    pub areal: Spread,
    /// Symmetric Dirichlet energy per area, likewise scaled; 4 for isometries.
    pub symmetric_dirichlet: Spread,
    /// Stretch of a texture, likewise scaled: L² of the surface; 1 at best.
    pub stretch: f64,
    /// The most that a texture is stretched, likewise scaled.
    pub largest_stretch: f64,
}

/// What `map` does to each face.
///
/// Errors: [`Error::WrongLength`]; [`dgp_mesh::Error::NotTriangle`] in [`Error::Mesh`]; [`Error::NoArea`].
pub fn face_distortions(
    mesh: &Mesh,
    map: &VertexMap<DVec2>,
) -> Result<FaceMap<FaceDistortion>, Error> {
    Error::check_length("the vertices", map.len(), mesh.vertex_count())?;
    require_triangles(mesh)?;
    let sides = mesh.map_faces(|f| {
        let h = mesh.face_halfedge(f);
        let (a, b) = (mesh.halfedge_vector(h), -mesh.halfedge_vector(mesh.prev(h)));
        // In the plane of the face, along its first side.
        let (length, normal) = (a.length(), a.cross(b).length());
        [DVec2::new(length, 0.0), DVec2::new(a.dot(b), normal) / length]
    });
    let has_area = |f: FaceId| sides[f][1].y > 0.0 && sides[f][0].x.is_finite();
    if let Some(face) = mesh.faces().find(|&f| !has_area(f)) {
        return Err(Error::NoArea { face });
    }
    Ok(mesh.map_faces(|f| {
        let h = mesh.face_halfedge(f);
        let origin = map[mesh.from(h)];
        let pictures = [map[mesh.to(h)] - origin, map[mesh.from(mesh.prev(h))] - origin];
        FaceDistortion::new(sides[f], pictures)
    }))
}

/// What `map` does to the surface as a whole.
///
/// Errors: those of [`face_distortions`].
pub fn distortion(mesh: &Mesh, map: &VertexMap<DVec2>) -> Result<DistortionReport, Error> {
    let faces = face_distortions(mesh, map)?;
    let areas = mesh.map_faces(|f| mesh.face_area(f));
    let area: f64 = areas.values().iter().sum();
    let ratio = |f: FaceId| faces[f].area_ratio();
    let mapped_area: f64 = mesh.faces().map(|f| areas[f] * ratio(f)).sum();
    let kept: Vec<FaceId> = mesh.faces().filter(|&f| ratio(f) > 0.0).collect();
    // Sizes of pictures mean nothing, so they are compared at the same area.
    let scale = (area / kept.iter().map(|&f| areas[f] * ratio(f)).sum::<f64>()).sqrt();
    let scaled = |f: FaceId| {
        let FaceDistortion { largest, smallest } = faces[f];
        FaceDistortion { largest: largest * scale, smallest: smallest * scale }
    };
    let spread = |measure: fn(&FaceDistortion) -> f64| {
        let mut spread = Spread { min: f64::INFINITY, mean: 0.0, max: 0.0 };
        let mut total = 0.0;
        for &f in &kept {
            let value = measure(&scaled(f));
            spread.min = spread.min.min(value);
            spread.max = spread.max.max(value);
            spread.mean += areas[f] * value;
            total += areas[f];
        }
        spread.mean /= total;
        if kept.is_empty() { Spread::default() } else { spread }
    };
    let square = spread(|face| face.stretch().powi(2));
    Ok(DistortionReport {
        flipped: mesh.faces().filter(|&f| ratio(f) < 0.0).count(),
        flat: mesh.faces().filter(|&f| ratio(f) == 0.0).count(),
        area,
        mapped_area,
        conformal: spread(FaceDistortion::conformal),
        areal: spread(FaceDistortion::areal),
        symmetric_dirichlet: spread(FaceDistortion::symmetric_dirichlet),
        stretch: square.mean.sqrt(),
        largest_stretch: spread(FaceDistortion::largest_stretch).max,
    })
}
