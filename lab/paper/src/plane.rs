//! Amplitude and frequency of a one-sine pulse → whether the paper's findings on Figures 6 and 7 hold.
//!
//! The paper's text does not give the pulse, but describes its effects on a block with α = 0.25, p = 1 rad/s, ξ_v = 0.1. With
//! ε = 0 and η = 20, 40, 60, 80 the peak rotation is slightly below that on the rigid base and rises towards it with η;
//! a larger ε or η makes separation more likely. The example `pulse_plane` draws the pulses with these effects, and
//! docs/unit/figures.md draws the conclusions.

use std::ops::Range;

use crate::parameters::{ALPHA, EPSILON, ETA, P, XI_V, block, history_pulse, run};
use rocking_block::block::{BlockError, Common};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_charts::canvas::{Mark, TEXT, drawing, text};
use rocking_charts::chart::{Chart, Tile};
use rocking_charts::formula::formula;
use rocking_charts::page::{Symbol, legend_height, with_legend};
use rocking_charts::picture::PictureError;
use rocking_studies::output::runner::in_parallel;
use rocking_studies::run::outcome::{End, Outcome};
use rocking_studies::spectrum::FoundationCurve;

/// Stiffness ratios beyond those of Figure 6 (1), for blocks with ε = 0.
pub const STIFFER_ETA: [f64; 5] = [100.0, 150.0, 200.0, 400.0, 800.0];

/// Interpretations of "slightly less": least ratios of the peaks to that on the rigid base (1).
pub const BOUNDS: [f64; 3] = [0.8, 0.85, 0.9];

/// Response of the block of Figures 6 and 7 to a pulse.
#[derive(Clone, Debug, PartialEq)]
pub struct PulseResponse {
    /// Peak |θ|/α on the rigid base (1), zero for a block at rest; `None` if it overturns.
    pub rigid: Option<f64>,
    /// Peaks on supports with ε = 0 over that on the rigid base (1), for each η of Figure 6; `None` without a peak.
    pub ratios: [Option<f64>; ETA.len()],
    /// Whether the block separates with ε = 0.4, for each η of Figure 6.
    pub separates: [bool; ETA.len()],
    /// Whether the block separates with ε = 0 at any η from 20 to 800.
    pub separates_without_restitution: bool,
}

impl PulseResponse {
    /// Computes the response to a pulse with a_p/(g tan α) = `amplitude` and ω_p/p = `frequency`.
    ///
    /// # Errors
    /// An invalid block.
    pub fn at(amplitude: f64, frequency: f64) -> Result<PulseResponse, BlockError> {
        let pulse = Pulse {
            shape: PulseShape::OneSine,
            amplitude: amplitude * g_tan(),
            period: std::f64::consts::TAU / (frequency * P),
            start: 0.0,
            ..Pulse::NONE
        };
        let outcome = |base| block(ALPHA, P, base).map(|block| run(block, pulse, Ground::default()).outcome());
        let peak = |outcome: &Outcome| (outcome.end == End::Completed).then_some(outcome.peaks.theta / ALPHA);
        let rigid = peak(&outcome(FoundationCurve::HOUSNER)?);
        let mut point = PulseResponse {
            rigid,
            ratios: [None; ETA.len()],
            separates: [false; ETA.len()],
            separates_without_restitution: false,
        };
        let Some(rigid) = rigid.filter(|peak| *peak > 0.0) else { return Ok(point) };
        let support = |eta, epsilon| FoundationCurve::viscoelastic(eta, XI_V, epsilon);
        for (i, &eta) in ETA.iter().enumerate() {
            let [without, with] = EPSILON.map(|epsilon| outcome(support(eta, epsilon)));
            let without = without?;
            point.ratios[i] = peak(&without).map(|peak| peak / rigid);
            point.separates[i] = with?.end == End::Separated;
            point.separates_without_restitution |= without.end == End::Separated;
        }
        for eta in STIFFER_ETA {
            point.separates_without_restitution |= outcome(support(eta, EPSILON[0]))?.end == End::Separated;
        }
        Ok(point)
    }

    /// Returns the least ratio of the peaks to that on the rigid base. All ratios are below 1 and rise with η; otherwise there is none.
    pub fn least_ratio(&self) -> Option<f64> {
        let ratios: Vec<f64> = self.ratios.iter().copied().collect::<Option<_>>()?;
        let rise = ratios.windows(2).all(|pair| pair[0] < pair[1]);
        (rise && ratios[ratios.len() - 1] < 1.0).then_some(ratios[0])
    }

    /// Returns true if the block with ε = 0.4 separates only as η grows. It does at an η of Figure 6 above the least.
    pub fn separates_as_eta_grows(&self) -> bool {
        !self.separates[0] && self.separates.contains(&true)
    }
}

fn g_tan() -> f64 {
    Common::default().gravity * libm::tan(ALPHA)
}

/// Evenly spaced points of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Least and greatest a_p/(g tan α) (1), and number of values.
    pub amplitude: (f64, f64, u64),
    /// Least and greatest ω_p/p (1), and number of values.
    pub frequency: (f64, f64, u64),
}

impl Grid {
    /// Grid of docs/pictures/pulse_plane.png.
    pub const FULL: Grid = Grid { amplitude: (1.0, 6.0, 101), frequency: (1.0, 15.0, 141) };

    fn value((from, to, count): (f64, f64, u64), i: u64) -> f64 {
        from + (to - from) * i as f64 / (count - 1) as f64
    }

    /// Returns amplitude and frequency of a point.
    pub fn coordinates(&self, point: u64) -> (f64, f64) {
        let Grid { amplitude, frequency } = *self;
        (Grid::value(amplitude, point / frequency.2), Grid::value(frequency, point % frequency.2))
    }

    /// Computes the responses to all pulses on the current pool of threads.
    ///
    /// # Errors
    /// An invalid block.
    pub fn responses(&self) -> Result<Vec<PulseResponse>, BlockError> {
        let points = in_parallel((self.amplitude.2 * self.frequency.2) as usize, |point| {
            let (amplitude, frequency) = self.coordinates(point as u64);
            PulseResponse::at(amplitude, frequency)
        });
        points.into_iter().collect()
    }

    /// Returns the points with a grey level as tiles. Adjacent points of the same level share one.
    fn tiles(&self, points: &[PulseResponse], grey: impl Fn(&PulseResponse) -> Option<u8>) -> Vec<Tile> {
        let half = |(from, to, count): (f64, f64, u64)| 0.5 * (to - from) / (count - 1) as f64;
        let [up, along] = [half(self.amplitude), half(self.frequency)];
        let mut tiles: Vec<Tile> = Vec::new();
        for (i, point) in (0..).zip(points) {
            let (amplitude, frequency) = self.coordinates(i);
            let Some(grey) = grey(point) else { continue };
            let y = amplitude - up..amplitude + up;
            match tiles.last_mut() {
                Some(last) if last.grey == grey && last.y == y && last.x.end > frequency - 1.5 * along => {
                    last.x.end = frequency + along;
                }
                _ => tiles.push(Tile { x: frequency - along..frequency + along, y, grey }),
            }
        }
        tiles
    }
}

/// Grey levels of ratios from each bound on.
const GREYS: [u8; BOUNDS.len()] = [205, 145, 70];
/// Grey level of ratios below all bounds.
const BELOW: u8 = 238;

/// Draws the pulses under which the findings hold.
///
/// At the left the peaks are below that on the rigid base and rise with η; at the right the block with ε = 0.4 also
/// separates as η grows.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn picture(grid: &Grid, points: &[PulseResponse]) -> Result<String, PictureError> {
    let range = |(from, to, _): (f64, f64, u64)| -> Range<f64> { from..to };
    let grey = |point: &PulseResponse| {
        let ratio = point.least_ratio()?;
        let bound = BOUNDS.iter().rposition(|bound| ratio >= *bound);
        Some(bound.map_or(BELOW, |bound| GREYS[bound]))
    };
    let Pulse { amplitude, period, .. } = history_pulse();
    let chosen = (std::f64::consts::TAU / period / P, amplitude / g_tan());
    let chart = |title: &str, tiles: Vec<Tile>| Chart {
        title: title.into(),
        x: ("ω_p/p", range(grid.frequency)),
        y: ("a_p/(g tan α)", range(grid.amplitude)),
        tiles,
        marks: vec![(Mark::Cross, chosen)],
        notes: [
            ((1.4, 5.0), "rigid block"),
            ((1.4, 4.78), "overturns"),
            ((4.2, 1.5), "a peak is above the rigid base's"),
            ((11.6, 5.0), "the peaks do"),
            ((11.6, 4.78), "not rise"),
        ]
        .map(|(at, note)| (at, note.into()))
        .into(),
        ..Chart::default()
    };
    let bounds = BOUNDS.iter().zip(GREYS).map(|(bound, grey)| (Symbol::Grey(grey), format!("≥ {bound}")));
    let mut legend = vec![(Symbol::Grey(BELOW), format!("least ratio < {}", BOUNDS[0]))];
    legend.extend(bounds);
    legend.push((Symbol::Mark(Mark::Cross), "pulse of Figures 6 to 8".into()));
    drawing(900 + legend_height(&legend) + 11_600, |root| {
        let (head, rest) = root.split_vertically(900);
        let line = "One-sine pulses under which the peaks on supports (η = 20, 40, 60, 80; ε = 0) are below the rigid base's and \
                    rise with η";
        head.draw_text(&formula(line), &text(TEXT), (480, 320))?;
        let rest = with_legend(&rest, &legend)?;
        let (left, right) = rest.split_horizontally(rest.dim_in_pixel().0 / 2);
        chart("(a) and (b)", grid.tiles(points, grey)).draw(root, &left)?;
        let with = |point: &PulseResponse| grey(point).filter(|_| point.separates_as_eta_grows());
        chart("and (c): ε = 0.4 separates at η = 40, 60 or 80, not at 20", grid.tiles(points, with)).draw(root, &right)
    })
}
