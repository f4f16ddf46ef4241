//! Light: where it comes from, and what a surface makes of it.
//!
//! Lamps stand still relative to the camera, so every view is lit as well as any other: a key light
//! from the upper left, a weak one from the right against dark shadows, one from behind that outlines
//! the shape, and a sky that is brighter than the ground. Diffuse parts are Lambert's, wrapped a
//! little around the terminator; highlights are Blinn's.
//!
//! - Input: a unit normal and the direction to the camera.
//! - Cost: O(1) for a sample.
//! - Reference: Blinn, "Models of light reflection for computer synthesized pictures", SIGGRAPH 1977.

use dgp_mesh::DVec3;

use crate::color::Linear;

/// A lamp infinitely far away.
struct Lamp {
    /// Toward it, in view coordinates, not normalized.
    direction: DVec3,
    strength: f64,
    /// How far beyond the terminator light reaches, as a cosine.
    wrap: f64,
}

const LAMPS: [Lamp; 3] = [
    Lamp { direction: DVec3::new(-0.45, 0.62, 0.75), strength: 0.80, wrap: 0.02 },
    Lamp { direction: DVec3::new(0.85, 0.05, 0.45), strength: 0.13, wrap: 0.25 },
    Lamp { direction: DVec3::new(0.25, 0.55, -0.80), strength: 0.22, wrap: 0.0 },
];

/// Light from above, and from below.
const SKY: f64 = 0.30;
const GROUND: f64 = 0.10;

/// Light that comes from the viewer, so that nothing seen head-on is dull.
const HEADLIGHT: f64 = 0.12;

/// The strength and the exponent of highlights.
const GLOSS: f64 = 0.10;
const GLOSS_EXPONENT: i32 = 24;

/// Lamps made ready.
pub(crate) struct Rig {
    lamps: [(DVec3, f64, f64); 3],
}

impl Rig {
    pub(crate) fn new() -> Self {
        Rig { lamps: LAMPS.map(|lamp| (lamp.direction.normalize(), lamp.strength, lamp.wrap)) }
    }

    /// The light a surface of color `albedo` with unit normal `n` sends to a viewer in direction `v`;
    /// `open` tells how much of the sky it sees, from 0 to 1.
    pub(crate) fn shade(&self, albedo: Linear, n: DVec3, v: DVec3, open: f64) -> Linear {
        let mut diffuse = GROUND + (SKY - GROUND) * (0.5 + 0.5 * n.y);
        diffuse += HEADLIGHT * n.dot(v).max(0.0);
        for &(direction, strength, wrap) in &self.lamps {
            diffuse += strength * ((n.dot(direction) + wrap) / (1.0 + wrap)).max(0.0);
        }
        let half = (self.lamps[0].0 + v).normalize_or_zero();
        let gloss = GLOSS * n.dot(half).max(0.0).powi(GLOSS_EXPONENT);
        let (diffuse, gloss) = ((diffuse * open) as f32, (gloss * open) as f32);
        albedo.map(|x| soften(x * diffuse + gloss))
    }
}

/// Bends what is brighter than white gently toward it instead of cutting it off.
fn soften(x: f32) -> f32 {
    const KNEE: f32 = 0.8;
    if x <= KNEE { x } else { 1.0 - (1.0 - KNEE) * (1.0 - KNEE) / (x - KNEE + 1.0 - KNEE) }
}
