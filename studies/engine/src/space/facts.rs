//! A block or a history in space → the numbers and words that summaries state, by name.

use rocking_block::space::{SpaceBody, SpaceEventKind, SpaceParameters, SpacePeaks};

/// Returns the numbers of a block.
pub fn of_block(parameters: &SpaceParameters, body: &SpaceBody) -> [(&'static str, f64); 17] {
    [
        ("alpha", body.alpha),
        ("alpha_edge", body.edge_angle()),
        ("p", body.p),
        ("omega_v", body.omega_v),
        ("xi_v", body.xi_v),
        ("kappa", parameters.kappa),
        ("xi_h", parameters.xi_h.unwrap_or(body.xi_v)),
        ("friction", body.friction),
        ("R0", body.r0),
        ("width", 2.0 * body.half_width),
        ("center_height", body.center_height),
        ("mass", body.mass),
        ("g", body.gravity),
        ("K", body.stiffness),
        ("C", body.damping),
        ("K_h", body.horizontal_stiffness),
        ("C_h", body.horizontal_damping),
    ]
}

/// Returns I_xx, I_yy, I_zz, I_xy, I_xz and I_yz of a block (kg.m²).
pub fn inertia(body: &SpaceBody) -> [f64; 6] {
    [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|place| body.inertia[place])
}

/// Returns x and y of each foot from the centre of mass, and its gap (m).
pub fn feet(body: &SpaceBody) -> Vec<[f64; 3]> {
    body.feet.iter().map(|foot| [foot.place.x, foot.place.y, foot.place.z + body.center_height]).collect()
}

/// Returns the greatest values of a run.
pub fn of_peaks(body: &SpaceBody, peaks: &SpacePeaks) -> [(&'static str, f64); 8] {
    [
        ("tilt", peaks.tilt()),
        ("tilt/alpha", peaks.tilt() / body.alpha),
        ("tilt/alpha_edge", peaks.tilt() / body.edge_angle()),
        ("twist", peaks.twist()),
        ("uplift", peaks.uplift),
        ("N", peaks.normal),
        ("slip", peaks.slip),
        ("drift", peaks.drift()),
    ]
}

/// Returns the word of an event, and the number of its foot from 0.
pub fn word(kind: SpaceEventKind) -> (&'static str, Option<usize>) {
    match kind {
        SpaceEventKind::LiftOff(foot) => ("lift-off", Some(foot)),
        SpaceEventKind::Landing(foot) => ("landing", Some(foot)),
        SpaceEventKind::Slides(foot) => ("slides", Some(foot)),
        SpaceEventKind::Sticks(foot) => ("sticks", Some(foot)),
        SpaceEventKind::Overturning => ("overturning", None),
    }
}
