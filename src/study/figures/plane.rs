//! Amplitude and frequency of a one-sine pulse → whether what the paper says of Figures 6 and 7 holds under it.
//!
//! The paper's text gives neither of the two, but says what they do to a block with α = 0.25, p = 1 rad/s, ξ_v = 0.1: with
//! ε = 0 and η = 20, 40, 60, 80 its peak rotation is slightly less than that on the rigid base, and rises towards it with η;
//! a larger ε separates more easily, and so does a larger η. `cargo run --release --example pulse_plane` draws where in the
//! plane of the two that is so; docs/figures.md says what follows from it.

use std::ops::Range;

use crate::block::{BlockError, Common};
use crate::excitation::{Pulse, PulseShape};
use crate::records::ground::Ground;
use crate::simulation::{Initial, Settings};
use crate::study::chart::{Cell, Chart, Sample, TEXT, drawing, keys, keys_height, text};
use crate::study::figures::parameters::{ALPHA, EPSILON, ETA, P, XI_V, block, history_pulse};
use crate::study::formula::formula;
use crate::study::history::Run;
use crate::study::outcome::{End, Outcome};
use crate::study::picture::PictureError;
use crate::study::runner;
use crate::study::spectrum::Base;

/// Stiffness ratios beyond those of Figure 6 (1), at which blocks with ε = 0 are looked at as well.
pub const STIFFER_ETA: [f64; 5] = [100.0, 150.0, 200.0, 400.0, 800.0];

/// What "slightly less" may mean: least ratios of the peaks to that on the rigid base (1).
pub const BOUNDS: [f64; 3] = [0.8, 0.85, 0.9];

/// What a pulse does to the block of Figures 6 and 7.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Peak |θ|/α on the rigid base (1), zero for a block that stays at rest; nothing if it overturns.
    pub rigid: Option<f64>,
    /// Peaks on supports with ε = 0 over that on the rigid base (1), for each η of Figure 6; nothing where there is none.
    pub ratios: [Option<f64>; ETA.len()],
    /// Whether it separates with ε = 0.4, for each of these η.
    pub separates: [bool; ETA.len()],
    /// Whether it separates with ε = 0, at any η from 20 to 800.
    pub separates_without_restitution: bool,
}

impl Point {
    /// The pulse with an amplitude a_p over g tan α (1) and a frequency ω_p over p (1).
    pub fn at(amplitude: f64, frequency: f64) -> Result<Point, BlockError> {
        let pulse = Pulse {
            shape: PulseShape::OneSine,
            amplitude: amplitude * g_tan(),
            period: std::f64::consts::TAU / (frequency * P),
            start: 0.0,
        };
        let outcome = |base: Base| -> Result<Outcome, BlockError> {
            let run = Run {
                block: block(ALPHA, P, base)?,
                settings: Settings::default(),
                initial: Initial::default(),
                pulse,
                ground: Ground::default(),
                duration: None,
                output_step: f64::INFINITY,
            };
            Ok(run.outcome())
        };
        let peak = |outcome: &Outcome| (outcome.end == End::Completed).then_some(outcome.peaks.theta / ALPHA);
        let rigid = peak(&outcome(Base::HOUSNER)?);
        let mut point = Point {
            rigid,
            ratios: [None; ETA.len()],
            separates: [false; ETA.len()],
            separates_without_restitution: false,
        };
        let Some(rigid) = rigid.filter(|peak| *peak > 0.0) else { return Ok(point) };
        let support = |eta, epsilon| Base::Viscoelastic { eta, xi_v: XI_V, epsilon };
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

    /// The least ratio of the peaks to that on the rigid base, if all of them are less than 1 and rise with η.
    pub fn least_ratio(&self) -> Option<f64> {
        let ratios: Vec<f64> = self.ratios.iter().copied().collect::<Option<_>>()?;
        let rise = ratios.windows(2).all(|pair| pair[0] < pair[1]);
        (rise && ratios[ratios.len() - 1] < 1.0).then_some(ratios[0])
    }

    /// Whether the block with ε = 0.4 separates as η grows: not at the least η of Figure 6, but at one of the others.
    pub fn separates_as_eta_grows(&self) -> bool {
        !self.separates[0] && self.separates.contains(&true)
    }
}

fn g_tan() -> f64 {
    Common::default().gravity * libm::tan(ALPHA)
}

/// Points of the plane, evenly spaced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Least and greatest a_p/(g tan α) (1), and how many.
    pub amplitude: (f64, f64, u64),
    /// Least and greatest ω_p/p (1), and how many.
    pub frequency: (f64, f64, u64),
}

impl Grid {
    /// That of the picture.
    pub const FULL: Grid = Grid { amplitude: (1.0, 6.0, 101), frequency: (1.0, 15.0, 141) };

    fn value((from, to, count): (f64, f64, u64), i: u64) -> f64 {
        from + (to - from) * i as f64 / (count - 1) as f64
    }

    /// Amplitude and frequency of a point.
    pub fn place(&self, point: u64) -> (f64, f64) {
        let Grid { amplitude, frequency } = *self;
        (Grid::value(amplitude, point / frequency.2), Grid::value(frequency, point % frequency.2))
    }

    /// What all pulses do.
    pub fn points(&self, pool: &rayon::ThreadPool) -> Result<Vec<Point>, BlockError> {
        let mut points = Vec::new();
        let make = |point| {
            let (amplitude, frequency) = self.place(point);
            Point::at(amplitude, frequency)
        };
        runner::in_order(pool, 0..self.amplitude.2 * self.frequency.2, make, |_, point| {
            points.push(point?);
            Ok(())
        })?;
        Ok(points)
    }

    /// The cells of these points that have a grey level, those beside each other in one.
    fn cells(&self, points: &[Point], grey: impl Fn(&Point) -> Option<u8>) -> Vec<Cell> {
        let half = |(from, to, count): (f64, f64, u64)| 0.5 * (to - from) / (count - 1) as f64;
        let [up, along] = [half(self.amplitude), half(self.frequency)];
        let mut cells: Vec<Cell> = Vec::new();
        for (i, point) in (0..).zip(points) {
            let (amplitude, frequency) = self.place(i);
            let Some(grey) = grey(point) else { continue };
            let y = amplitude - up..amplitude + up;
            match cells.last_mut() {
                Some(last) if last.grey == grey && last.y == y && last.x.end > frequency - 1.5 * along => {
                    last.x.end = frequency + along;
                }
                _ => cells.push(Cell { x: frequency - along..frequency + along, y, grey }),
            }
        }
        cells
    }
}

/// Grey levels of the bounds, and of ratios below all of them.
const GREYS: [u8; BOUNDS.len()] = [205, 145, 70];
const BELOW: u8 = 238;

/// Draws the plane: where the peaks are below that on the rigid base and rise with η, and where the block with ε = 0.4
/// separates as η grows, too.
pub fn picture(grid: &Grid, points: &[Point]) -> Result<String, PictureError> {
    let range = |(from, to, _): (f64, f64, u64)| -> Range<f64> { from..to };
    let grey = |point: &Point| {
        let ratio = point.least_ratio()?;
        let bound = BOUNDS.iter().rposition(|bound| ratio >= *bound);
        Some(bound.map_or(BELOW, |bound| GREYS[bound]))
    };
    let chart = |title: &str, cells: Vec<Cell>| Chart {
        title: title.into(),
        x: ("ω_p/p", range(grid.frequency)),
        y: ("a_p/(g tan α)", range(grid.amplitude)),
        cells,
        crosses: vec![{
            let Pulse { amplitude, period, .. } = history_pulse();
            (std::f64::consts::TAU / period / P, amplitude / g_tan())
        }],
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
    let bounds = BOUNDS.iter().zip(GREYS).map(|(bound, grey)| (Sample::Bar(grey), format!("≥ {bound}")));
    let mut samples = vec![(Sample::Bar(BELOW), format!("least ratio < {}", BOUNDS[0]))];
    samples.extend(bounds);
    samples.push((Sample::Cross, "pulse of Figures 6 to 8".into()));
    drawing(900 + keys_height(&samples) + 11_600, |root| {
        let (head, rest) = root.split_vertically(900);
        let line = "One-sine pulses under which the peaks on supports (η = 20, 40, 60, 80; ε = 0) are below the rigid base's and \
                    rise with η";
        head.draw_text(&formula(line), &text(TEXT), (480, 320))?;
        let (area, rest) = rest.split_vertically(keys_height(&samples));
        keys(&area, &samples)?;
        let (left, right) = rest.split_horizontally(rest.dim_in_pixel().0 / 2);
        chart("(a) and (b)", grid.cells(points, grey)).draw(root, &left)?;
        let with = |point: &Point| grey(point).filter(|_| point.separates_as_eta_grows());
        chart("and (c): ε = 0.4 separates at η = 40, 60 or 80, not at 20", grid.cells(points, with)).draw(root, &right)
    })
}
