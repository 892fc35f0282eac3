//! A block or a history in space → the numbers and words that summaries state, by name.

use rocking_block::space::{SpaceBody, SpaceEventKind, SpaceParameters, SpacePeaks};

/// Returns the numbers of a block.
pub fn of_block(parameters: &SpaceParameters, body: &SpaceBody) -> [(&'static str, f64); 17] {
    [
        ("alpha", body.alpha),
        ("alpha_edge", body.edge_angle),
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

/// The greatest values of a run: names and units.
///
/// `tilt/alpha` is the tilt over the critical one in the direction of the lean.
pub const PEAKS: [(&str, &str); 7] = [
    ("tilt", "rad"),
    ("tilt/alpha", "1"),
    ("twist", "rad"),
    ("uplift", "m"),
    ("N", "N"),
    ("slip", "m"),
    ("drift", "m"),
];

/// Returns the greatest values of a run, in the order of [`PEAKS`].
pub fn peaks(peaks: &SpacePeaks) -> [f64; PEAKS.len()] {
    let &SpacePeaks { tilt_over_critical, uplift, normal, slip, .. } = peaks;
    [peaks.tilt(), tilt_over_critical, peaks.twist(), uplift, normal, slip, peaks.drift()]
}

/// Returns the greatest values of a run by their names.
pub fn of_peaks(of_run: &SpacePeaks) -> [(&'static str, f64); PEAKS.len()] {
    let values = peaks(of_run);
    std::array::from_fn(|place| (PEAKS[place].0, values[place]))
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
