//! What the figures are made with, in one place; captions and documentation take it from here.
//!
//! Where the paper's text gives a value it stands here as it is there. What it does not give was chosen, and
//! [`caption`] says so.

use std::f64::consts::TAU;

use crate::block::{Block, BlockError, Common, Dimensionless, Foundation};
use crate::excitation::{Pulse, PulseShape};
use crate::study::spectrum::Base;

/// Numbers of the figures, the paper's.
pub const NUMBERS: [u8; 10] = [3, 6, 7, 8, 9, 10, 11, 12, 13, 14];

/// Slenderness angles of Figure 3 (rad). Chosen.
pub const RESTITUTION_ALPHA: [f64; 5] = [0.05, 0.10, 0.15, 0.20, 0.25];

/// Slenderness angle of Figures 6 to 8, 12 and 13 (rad). The paper's for the histories, chosen for the spectra.
pub const ALPHA: f64 = 0.25;
/// Frequency parameter of Figures 6 to 9 (rad/s). The paper's.
pub const P: f64 = 1.0;
/// Damping ratio of Figures 6 to 8 (1). The paper's.
pub const XI_V: f64 = 0.1;
/// Stiffness ratios of Figures 6 and 9 (1). The paper's range.
pub const ETA: [f64; 4] = [20.0, 40.0, 60.0, 80.0];
/// Stiffness ratio of Figures 7 and 8 (1). Chosen.
pub const ETA_OF_RESTITUTIONS: f64 = 40.0;
/// Restitutions ε of Figures 7 and 8 (1). The last is the paper's, the others are chosen.
pub const EPSILON: [f64; 3] = [0.0, 0.2, 0.4];
/// Amplitude of the pulse of Figures 6 to 8 over g tan α (1). Chosen.
pub const PULSE_AMPLITUDE: f64 = 2.5;
/// Frequency ω_p of the pulses of Figures 6 to 8, 10 and 11 (rad/s). Chosen.
pub const PULSE_FREQUENCY: f64 = 5.0;
/// Duration of the histories (s). Chosen.
pub const HISTORY_DURATION: f64 = 8.0;

/// θ̇(0) over α p of Figure 9 (1). The paper's.
pub const RATE: f64 = 0.95;
/// Least and greatest slenderness angle of Figure 9 (rad). Chosen.
pub const DAMPING_ALPHA: [f64; 2] = [0.05, 0.35];
/// Greatest damping ratio that Figure 9 looks at (1). Chosen.
pub const GREATEST_XI_V: f64 = 1.0;
/// Restitutions of Figure 9 (1). Chosen.
pub const DAMPING_EPSILON: [f64; 2] = [0.0, 0.4];

/// Amplitudes of the pulses of Figures 10 and 11 over g tan α (1). Chosen.
pub const SPECTRUM_AMPLITUDE: [f64; 2] = [1.5, 2.5];
/// Slenderness angles of Figures 10 and 11 (rad). Chosen.
pub const SPECTRUM_ALPHA: [f64; 4] = [0.10, 0.15, 0.20, 0.25];
/// Foundations of Figures 10 and 11. Chosen.
pub const PULSE_BASES: [Base; 5] = [
    Base::HOUSNER,
    Base::Viscoelastic { eta: 20.0, xi_v: 0.1, epsilon: 0.0 },
    Base::Viscoelastic { eta: 80.0, xi_v: 0.1, epsilon: 0.0 },
    Base::Viscoelastic { eta: 80.0, xi_v: 0.4, epsilon: 0.0 },
    Base::Viscoelastic { eta: 80.0, xi_v: 0.1, epsilon: 0.4 },
];
/// Least and greatest ω_p/p of Figures 10 and 11 (1). Chosen.
pub const PULSE_RATIO: [f64; 2] = [0.5, 10.0];

/// Foundations of Figures 12 and 13: damping and restitution are the paper's where its text names them (ξ_v = 0.4, ε = 0),
/// the rest is chosen.
pub const RECORD_BASES: [Base; 5] = [
    Base::HOUSNER,
    Base::Viscoelastic { eta: 60.0, xi_v: 0.1, epsilon: 0.0 },
    Base::Viscoelastic { eta: 60.0, xi_v: 0.1, epsilon: 0.4 },
    Base::Viscoelastic { eta: 60.0, xi_v: 0.4, epsilon: 0.0 },
    Base::Viscoelastic { eta: 60.0, xi_v: 0.4, epsilon: 0.4 },
];
/// Least and greatest p of Figures 12 and 13 (rad/s). Chosen.
pub const RECORD_P: [f64; 2] = [0.5, 4.0];

/// Frequency parameter of the bridge tower (rad/s). The paper's.
pub const TOWER_P: f64 = 0.38;
/// Slenderness angle of the bridge tower (rad). The paper's.
pub const TOWER_ALPHA: f64 = 0.15;
/// Stiffness ratios of the bridge tower (1): soils, and pads with S = 5 and 10. The paper's.
pub const TOWER_ETA: [f64; 5] = [40.0, 60.0, 100.0, 305.0, 863.0];
/// Damping ratio and restitution of the bridge tower (1). Chosen.
pub const TOWER_SUPPORT: [f64; 2] = [0.1, 0.0];

/// What counts as what.
const FALLING: &str = "What separates beyond |θ| = α, on its way down, counts as overturned";

/// How finely the figures are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// Time between two rows of a history (s).
    pub step: f64,
    /// Slenderness angles of each curve of Figure 9, at least two.
    pub slendernesses: u64,
    /// Damping ratios at which each search of Figure 9 scans, at least two.
    pub dampings: u64,
    /// Sizes of each spectrum, at least two.
    pub sizes: u64,
}

impl Detail {
    /// That of the pictures.
    pub const FULL: Detail = Detail { step: 0.005, slendernesses: 31, dampings: 101, sizes: 400 };
}

/// A block on a foundation, with the mass and the gravity of [`Common::default`].
pub fn block(alpha: f64, p: f64, base: Base) -> Result<Block, BlockError> {
    // The rigid base reads neither η nor ξ_v; any that make a block will do.
    let (foundation, eta, xi_v, epsilon, restitution_factor) = match base {
        Base::Rigid { epsilon, restitution_factor } => (Foundation::Rigid, 40.0, 0.1, epsilon, restitution_factor),
        Base::Viscoelastic { eta, xi_v, epsilon } => (Foundation::Viscoelastic, eta, xi_v, epsilon, 1.0),
    };
    Block::from_dimensionless(
        &Dimensionless { alpha, p, eta, xi_v },
        &Common { epsilon, foundation, restitution_factor, ..Common::default() },
    )
}

/// A one-sine pulse of this amplitude over g tan α.
pub fn pulse(amplitude: f64, alpha: f64) -> Pulse {
    let amplitude = amplitude * Common::default().gravity * libm::tan(alpha);
    Pulse { shape: PulseShape::OneSine, amplitude, period: TAU / PULSE_FREQUENCY, start: 0.0 }
}

/// What a figure shows and with what it was made; nothing for a number that is none of [`NUMBERS`].
pub fn caption(number: u8) -> Option<String> {
    let etas = list(&ETA);
    let one_sine = format!(
        "α = {ALPHA}, p = {P} rad/s, ξ_v = {XI_V}; one-sine pulse with a_p = {PULSE_AMPLITUDE} g tan α = {:.3} m/s² and \
         ω_p = {PULSE_FREQUENCY} rad/s (both chosen here)",
        pulse(PULSE_AMPLITUDE, ALPHA).amplitude
    );
    let pulses = |amplitude: f64| {
        format!(
            "Peak rotation under a one-sine pulse of amplitude a_p = {amplitude} g tan α (chosen here) over ω_p/p, ω_p = \
             {PULSE_FREQUENCY} rad/s. A vertical line in the style of a curve stands at the greatest ω_p/p at which its \
             block separates: the separation limit. {FALLING}"
        )
    };
    let records = "Peak rotation under the records of Table I, or the pulse of Table I where the record is not at hand";
    let record_blocks = format!("α = {ALPHA}, η = 60 (chosen here). {FALLING}");
    Some(match number {
        3 => format!(
            "Housner's restitution e that a restitution ε of the landing corner amounts to, eq. (6), γ = 3, for α = {} rad",
            list(&RESTITUTION_ALPHA)
        ),
        6 => format!(
            "Rotation and vertical motion on supports of η = {etas} with ε = 0, and on the rigid base. {one_sine}"
        ),
        7 => format!(
            "Rotation and vertical motion with ε = {}, η = {ETA_OF_RESTITUTIONS}, and on the rigid base. {one_sine}",
            list(&EPSILON)
        ),
        8 => format!(
            "Energy with ε = {}, η = {ETA_OF_RESTITUTIONS}, and on the rigid base, over the energy M g R0 (1 − cos α) that overturns the block. {one_sine}",
            list(&EPSILON)
        ),
        9 => format!(
            "Least damping ratio ξ_v against complete separation in free vibration from θ̇(0) = {RATE} α p, for η = {etas}. No separation from this ξ_v to {GREATEST_XI_V}. {FALLING}. ε = {} is chosen here",
            list(&DAMPING_EPSILON)
        ),
        10 => pulses(SPECTRUM_AMPLITUDE[0]),
        11 => pulses(SPECTRUM_AMPLITUDE[1]),
        12 => format!("{records}, without vertical motion. {record_blocks}"),
        13 => format!("{records}, with vertical motion where its record is at hand. {record_blocks}"),
        14 => format!(
            "Peak rotation of the bridge tower, p = {TOWER_P} rad/s, α = {TOWER_ALPHA}, on supports of η = {} and on the rigid base, under the records of Table I, or the pulse of Table I where the record is not at hand. ξ_v = {}, ε = {} (chosen here)",
            list(&TOWER_ETA),
            TOWER_SUPPORT[0],
            TOWER_SUPPORT[1]
        ),
        _ => return None,
    })
}

fn list(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")
}
