//! Parameters of the figures, for captions and documentation as well.
//!
//! Values of the paper's text are marked as the paper's. Other values were chosen here, and [`caption`] says so.

use std::f64::consts::TAU;

use rocking_block::block::{Block, BlockError, Common, Dimensionless};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::{Initial, Settings};
use rocking_studies::run::Run;
use rocking_studies::spectrum::FoundationCurve;

/// Numbers of the figures in the paper.
pub const NUMBERS: [u8; 10] = [3, 6, 7, 8, 9, 10, 11, 12, 13, 14];

/// Slenderness angles of Figure 3 (rad). Chosen.
pub const RESTITUTION_ALPHA: [f64; 5] = [0.05, 0.10, 0.15, 0.20, 0.25];

/// Slenderness angle of Figures 6 to 8, 12 and 13 (rad). The paper's.
pub const ALPHA: f64 = 0.25;
/// Frequency parameter of Figures 6 to 9 (rad/s). The paper's.
pub const P: f64 = 1.0;
/// Damping ratio of Figures 6 and 7 (1). The paper's.
pub const XI_V: f64 = 0.1;
/// Stiffness ratios of Figures 6, 7 and 9 (1). The paper's.
pub const ETA: [f64; 4] = [20.0, 40.0, 60.0, 80.0];
/// Restitutions ε of Figures 7 to 9 (1). The paper's.
pub const EPSILON: [f64; 2] = [0.0, 0.4];
/// Damping ratios of Figure 8 (1). The paper's.
pub const ENERGY_XI_V: [f64; 2] = [0.1, 0.4];
/// Stiffness ratio of Figure 8 (1). Chosen.
pub const ENERGY_ETA: f64 = 40.0;
/// Amplitude (m/s²) and period (s) of the pulse of Figures 6 to 8. Chosen.
///
/// The paper's text does not give them. These are of Rinaldi, the only one-sine pulse of Table I; under it the paper's
/// findings hold (see [`plane`](super::plane)).
pub const PULSE: [f64; 2] = [6.87, 0.80];
/// Duration of the histories (s). Chosen.
pub const HISTORY_DURATION: f64 = 10.0;

/// θ̇(0) over α p of Figure 9 (1). The paper's.
pub const RATE: f64 = 0.95;
/// Least and greatest slenderness angle of Figure 9 (rad). Chosen.
pub const DAMPING_ALPHA: [f64; 2] = [0.05, 0.35];
/// Greatest damping ratio of Figure 9 (1). Chosen.
pub const GREATEST_XI_V: f64 = 1.0;

/// Amplitudes of the pulses of Figures 10 and 11 over g tan α (1). Chosen.
pub const SPECTRUM_AMPLITUDE: [f64; 2] = [1.5, 2.5];
/// Frequency ω_p of the pulses of Figures 10 and 11 (rad/s). By similarity only ω_p/p matters.
pub const SPECTRUM_FREQUENCY: f64 = 5.0;
/// Slenderness angles of Figures 10 and 11 (rad). Chosen.
pub const SPECTRUM_ALPHA: [f64; 4] = [0.10, 0.15, 0.20, 0.25];
/// Foundations of Figures 10 and 11. Chosen.
pub const PULSE_BASES: [FoundationCurve; 5] = [
    FoundationCurve::HOUSNER,
    FoundationCurve::viscoelastic(20.0, 0.1, 0.0),
    FoundationCurve::viscoelastic(80.0, 0.1, 0.0),
    FoundationCurve::viscoelastic(80.0, 0.4, 0.0),
    FoundationCurve::viscoelastic(80.0, 0.1, 0.4),
];
/// Least and greatest ω_p/p of Figures 10 and 11 (1). Chosen.
pub const PULSE_RATIO: [f64; 2] = [1.0, 10.0];

/// Damping ratios and restitutions of the panels of Figures 12 and 13 (1). The paper's.
pub const RECORD_SUPPORTS: [[f64; 2]; 4] = [[0.1, 0.0], [0.1, 0.4], [0.4, 0.0], [0.4, 0.4]];
/// Stiffness ratios of Figures 12 and 13 (1): the ends of the range of Figure 6. Chosen.
pub const RECORD_ETA: [f64; 2] = [20.0, 80.0];
/// Least and greatest p of Figures 12 and 13 (rad/s). Chosen.
pub const RECORD_P: [f64; 2] = [0.5, 4.0];

/// Frequency parameter of the bridge tower (rad/s). The paper's.
pub const TOWER_P: f64 = 0.38;
/// Slenderness angle of the bridge tower (rad). The paper's.
pub const TOWER_ALPHA: f64 = 0.15;
/// Stiffness ratios of the bridge tower (1). The paper's.
pub const TOWER_ETA: [f64; 3] = [40.0, 60.0, 100.0];
/// Stiffness ratios of the bridge tower on pads with S = 5 and 10 (1). They are values of the paper, and only in the table.
pub const PAD_ETA: [f64; 2] = [305.0, 863.0];
/// Damping ratio and restitution of the bridge tower (1). Chosen.
pub const TOWER_SUPPORT: [f64; 2] = [0.1, 0.0];

/// Resolution of the figures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// Output step of a history (s).
    pub step: f64,
    /// Number of slenderness angles per curve of Figure 9, at least two.
    pub slendernesses: u64,
    /// Number of damping ratios per scan of Figure 9, at least two.
    pub dampings: u64,
    /// Number of sizes per spectrum, at least two.
    pub sizes: u64,
}

impl Detail {
    /// Resolution of the published figures.
    pub const FULL: Detail = Detail { step: 0.005, slendernesses: 31, dampings: 101, sizes: 400 };
}

/// Returns a block on a foundation, with the mass and the gravity of [`Common::default`].
///
/// # Errors
/// The first invalid parameter.
pub fn block(alpha: f64, p: f64, base: FoundationCurve) -> Result<Block, BlockError> {
    let common = Common { epsilon: base.epsilon, ..Common::default() };
    Block::from_dimensionless(&Dimensionless { alpha, p, supports: base.supports }, &common)
}

/// Returns a run until the block has come to rest or overturned. It begins at rest and has no rows in between.
pub fn run(block: Block, pulse: Pulse, ground: Ground) -> Run {
    Run {
        block,
        settings: Settings::default(),
        initial: Initial::default(),
        pulse,
        ground,
        duration: None,
        output_step: f64::INFINITY,
    }
}

/// Returns the pulse of Figures 6 to 8.
pub fn history_pulse() -> Pulse {
    let [amplitude, period] = PULSE;
    Pulse { shape: PulseShape::OneSine, amplitude, period, start: 0.0, ..Pulse::NONE }
}

/// Returns the pulse of Figure 10 (one sine) or 11 (one cosine). The amplitude is over g tan α.
pub fn spectrum_pulse(number: u8, amplitude: f64, alpha: f64) -> Pulse {
    let shape = if number == 10 { PulseShape::OneSine } else { PulseShape::OneCosine };
    let amplitude = amplitude * Common::default().gravity * libm::tan(alpha);
    Pulse { shape, amplitude, period: TAU / SPECTRUM_FREQUENCY, start: 0.0, ..Pulse::NONE }
}

/// Returns the caption of a figure, with its parameters, or `None` for a number outside [`NUMBERS`].
///
/// No-break spaces hold formulas together.
pub fn caption(number: u8) -> Option<String> {
    Some(text(number)?.replace('~', "\u{A0}"))
}

/// Returns the caption with `~` for each no-break space.
fn text(number: u8) -> Option<String> {
    let etas = list(&ETA);
    let [amplitude, period] = PULSE;
    let g_tan = Common::default().gravity * libm::tan(ALPHA);
    let one_sine = format!(
        "α~=~{ALPHA}, p~=~{P}~rad/s. One-sine pulse with a_p~=~{amplitude}~m/s²~=~{:.2}~g~tan~α and T_p~=~{period}~s, \
         ω_p/p~=~{:.2}: that of Rinaldi in Table~I, since the paper does not state the pulse of its figure",
        amplitude / g_tan,
        TAU / period / P,
    );
    let ends = "The analysis ends at complete separation~(×)";
    let band = "Shaded: both corners touch, |θ|~≤~β of eq.~(29)";
    let pulses = |shape: &str| {
        format!(
            "Peak rotation under a {shape} pulse with a_p~=~{}~g~tan~α (left) and {}~g~tan~α (right), for α~=~{}~rad \
             from top to bottom; T_p~=~2π/ω_p. A vertical line in the style of a curve marks the ω_p/p above which its \
             block does not separate. As in the paper, the analysis ends at complete separation; a block that separates \
             has no peak. Amplitudes, α and foundations are chosen here",
            SPECTRUM_AMPLITUDE[0],
            SPECTRUM_AMPLITUDE[1],
            list(&SPECTRUM_ALPHA)
        )
    };
    let records = |stations: &str| {
        format!(
            "Peak rotation under {stations}, with the horizontal motion a_gx alone (left) and with the vertical motion \
             a_gz as well (right). α~=~{ALPHA}; η~=~{} and p~=~{} to {}~rad/s are chosen here. As in the paper, the \
             analysis ends at complete separation; a block that separates has no peak",
            list(&RECORD_ETA),
            RECORD_P[0],
            RECORD_P[1]
        )
    };
    Some(match number {
        3 => format!(
            "Housner's restitution e equivalent to a restitution ε of the landing corner, eq.~(6), for γ~=~3 and α~=~{}~rad",
            list(&RESTITUTION_ALPHA)
        ),
        6 => format!(
            "Rotation θ and its rate θ̇ on the rigid base and on viscoelastic supports with η~=~{etas}. ξ_v~=~{XI_V}, \
             ε~=~0, {one_sine}. {band}"
        ),
        7 => format!(
            "Rotation θ and its rate θ̇ on viscoelastic supports with ε~=~{} and ε~=~{}, for η~=~{etas}. ξ_v~=~{XI_V}, \
             {one_sine}. {band}. {ends}",
            EPSILON[0], EPSILON[1]
        ),
        8 => format!(
            "Total energy E on the rigid base and on viscoelastic supports with ε~=~{} and ξ_v~=~{}, over the energy \
             M~g~R0~(1~−~cos~α) that overturns the block on the rigid base, where ε~=~0. η~=~{ENERGY_ETA} (chosen here), \
             {one_sine}",
            list(&EPSILON),
            list(&ENERGY_XI_V)
        ),
        9 => format!(
            "Least damping ratio ξ_v that prevents complete separation in free vibration from θ(0)~=~0, \
             θ̇(0)~=~{RATE}~α~p, for η~=~{etas}: no block separates between this ξ_v and {GREATEST_XI_V}. A block that \
             leaves its supports at |θ|~≥~α counts as overturned, not as separated"
        ),
        10 => pulses("one-sine"),
        11 => pulses("one-cosine"),
        12 => records("Pacoima Dam and Erzincan"),
        13 => records("Sylmar and Rinaldi"),
        14 => format!(
            "Peak rotation of the bridge tower, p~=~{TOWER_P}~rad/s, α~=~{TOWER_ALPHA}, on viscoelastic supports (bars) and \
             on the rigid base (dash-dotted lines), under the records of Table~I in order of growing PGA (the paper's \
             values). The supports' ξ_v~=~{} and ε~=~{} are chosen here",
            TOWER_SUPPORT[0], TOWER_SUPPORT[1]
        ),
        _ => return None,
    })
}

/// Lists values with no-break spaces between them.
fn list(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(",~")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rocking_charts::canvas::TEXT;
    use rocking_charts::formula::width;
    use rocking_charts::page::wrapped;

    /// Every caption fits its lines, and no line breaks inside a formula.
    #[test]
    fn captions_break_between_words() {
        for caption in NUMBERS.map(|number| caption(number).unwrap()) {
            let lines = wrapped(&caption, TEXT, 12_000.0);
            assert!(lines.len() > 1 && lines.iter().all(|line| width(line, TEXT) <= 12_000.0), "{lines:?}");
            for line in &lines[..lines.len() - 1] {
                let end = line.trim_end_matches([',', '.', ';', ')']).chars().last().unwrap();
                assert!(!"=+−·".contains(end), "{lines:?}");
            }
            for line in &lines[1..] {
                assert!(!line.starts_with(['=', '+', '−', '·']), "{lines:?}");
            }
        }
    }
}
