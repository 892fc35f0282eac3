//! Figures 6 to 8: histories of rotation, vertical motion and energy under a one-sine pulse.

use crate::block::BlockError;
use crate::simulation::{Ending, Initial, Settings};
use crate::study::figures::page::{Chart, Curve, keys, page, range};
use crate::study::figures::parameters::{
    ALPHA, Detail, EPSILON, ETA, ETA_OF_RESTITUTIONS, HISTORY_DURATION, P, PULSE_AMPLITUDE, XI_V, block, pulse,
};
use crate::study::figures::table::Table;
use crate::study::figures::{Figure, FigureError, Work};
use crate::study::ground::Ground;
use crate::study::history::{History, Row, Run};
use crate::study::plot::short;
use crate::study::spectrum::Base;

const COLUMNS: [&str; 15] = [
    "foundation",
    "t",
    "theta/alpha",
    "theta_dot/(alpha p)",
    "v/R0",
    "N_L/(M g)",
    "N_R/(M g)",
    "regime",
    "energy.total",
    "energy.input",
    "energy.dashpots",
    "energy.impacts",
    "a_gx",
    "peak.theta/alpha",
    "end",
];

/// What a chart shows of a run.
type Value = fn(&Made, &Row) -> f64;

/// A run, and what it did.
struct Made {
    base: Base,
    run: Run,
    history: History,
}

/// What the blocks of a figure stand on, the rigid base first.
pub fn bases(number: u8) -> Vec<Base> {
    let support = |eta, epsilon| Base::Viscoelastic { eta, xi_v: XI_V, epsilon };
    let supports: Vec<Base> = match number {
        6 => ETA.iter().map(|&eta| support(eta, 0.0)).collect(),
        _ => EPSILON.iter().map(|&epsilon| support(ETA_OF_RESTITUTIONS, epsilon)).collect(),
    };
    std::iter::once(Base::HOUSNER).chain(supports).collect()
}

/// The run of a block of Figures 6 to 8.
pub fn history_run(base: Base, detail: &Detail) -> Result<Run, BlockError> {
    Ok(Run {
        block: block(ALPHA, P, base)?,
        settings: Settings::default(),
        initial: Initial::default(),
        pulse: pulse(PULSE_AMPLITUDE, ALPHA),
        ground: Ground::default(),
        duration: Some(HISTORY_DURATION),
        output_step: detail.step,
    })
}

/// Makes Figure 6, 7 or 8.
pub fn figure(number: u8, caption: &str, detail: &Detail, work: &mut Work) -> Result<Figure, FigureError> {
    let bases = bases(number);
    let made: Vec<Made> = work
        .make(bases.len() as u64, |task| -> Result<Made, FigureError> {
            let base = bases[task as usize];
            let run = history_run(base, detail)?;
            let history = run.history(|_| ())?;
            Ok(Made { base, run, history })
        })
        .into_iter()
        .collect::<Result<_, _>>()?;
    let svg = if number == 8 { energies(caption, &made)? } else { motions(number, caption, &made)? };
    Ok(Figure { number, svg, table: table(number, caption, &made)?, failed: 0 })
}

fn table(number: u8, caption: &str, made: &[Made]) -> csv::Result<String> {
    let mut lines: Vec<String> = made.iter().map(|made| format!("foundation {}: {}", made.base, made.end())).collect();
    lines.push("t in s, a_gx in m/s2, energies over M g R0 (1 - cos alpha); a foundation is eta,xi_v,epsilon".into());
    let mut table = Table::new(number, caption, &lines, &COLUMNS)?;
    for made in made {
        let block = &made.run.block;
        let (weight, scale) = (block.mass * block.gravity, made.energy_scale());
        for row in &made.history.rows {
            let numbers = [
                row.time,
                row.seen.theta / block.alpha,
                row.seen.theta_dot / (block.alpha * block.p),
                row.seen.v / block.r0,
                row.seen.reaction[0] / weight,
                row.seen.reaction[1] / weight,
                row.regime.number().into(),
                row.energies.total / scale,
                row.energies.input / scale,
                row.energies.dashpots / scale,
                row.energies.impacts / scale,
                row.ground[0],
                made.peak(),
            ];
            let fields = numbers.map(|number| number.to_string());
            table.push([made.base.to_string()].into_iter().chain(fields).chain([made.end()]))?;
        }
    }
    table.finish()
}

impl Made {
    /// Peak |θ|/α until the end of the run.
    fn peak(&self) -> f64 {
        self.history.peaks.theta / self.run.block.alpha
    }

    /// M g R0 (1 − cos α) (J): what it takes to overturn the block slowly.
    fn energy_scale(&self) -> f64 {
        let block = &self.run.block;
        block.mass * block.gravity * block.r0 * (1.0 - libm::cos(block.alpha))
    }

    fn end(&self) -> String {
        match self.history.ending {
            None => "completed".into(),
            Some((Ending::Separated, time)) => format!("separated at {time:.3} s"),
            Some((Ending::Toppled | Ending::Overturned, time)) => format!("overturned at {time:.3} s"),
        }
    }

    fn curve(&self, look: usize, value: impl Fn(&Row) -> f64) -> Curve {
        let points = self.history.rows.iter().map(|row| (row.time, value(row))).collect();
        Curve { look, pieces: vec![points], ends: self.history.ending.is_some() }
    }

    /// What the supports are, in a few words.
    fn name(&self) -> String {
        match self.base {
            Base::Rigid { .. } => "rigid base".into(),
            Base::Viscoelastic { eta, epsilon, .. } => format!("η = {}, ε = {}", short(eta), short(epsilon)),
        }
    }
}

/// A row of two charts for each viscoelastic foundation, with the rigid base beside it.
fn motions(number: u8, caption: &str, made: &[Made]) -> Result<String, FigureError> {
    let Some((rigid, supports)) = made.split_first() else { return Err(FigureError::Number(number)) };
    let theta = |made: &Made, row: &Row| row.seen.theta / made.run.block.alpha;
    let height = |made: &Made, row: &Row| 1000.0 * row.seen.v / made.run.block.r0;
    let spans = [theta, height].map(|value: Value| {
        range(made.iter().flat_map(|made| made.history.rows.iter().map(move |row| value(made, row))))
    });
    let svg = page(number, caption, [2000, 56 + 380 * supports.len() as u32], |root, body| {
        let (key, body) = body.split_vertically(56);
        keys(&key, &[(0, "on supports".into()), (2, "rigid base".into())])?;
        for (area, made) in body.split_evenly((supports.len(), 1)).iter().zip(supports) {
            let (left, right) = area.split_horizontally(1000);
            let title = format!("{}: peak |θ|/α = {:.4}, rigid base {:.4}", made.name(), made.peak(), rigid.peak());
            let ended = if made.history.ending.is_some() { made.end() } else { String::new() };
            let pairs = [
                (left, title, "θ / α", theta as Value, spans[0].clone()),
                (right, ended, "1000 v / R0", height, spans[1].clone()),
            ];
            for (area, title, name, value, span) in pairs {
                let title = if title.is_empty() { " ".into() } else { title };
                let curves = vec![rigid.curve(2, |row| value(rigid, row)), made.curve(0, |row| value(made, row))];
                let chart = Chart { title, x: ("t (s)", 0.0..HISTORY_DURATION), y: (name, span), curves };
                chart.draw(root, &area)?;
            }
        }
        Ok(())
    })?;
    Ok(svg)
}

/// Energy, and under it what dashpots and impacts took.
fn energies(caption: &str, made: &[Made]) -> Result<String, FigureError> {
    let total = |made: &Made, row: &Row| row.energies.total / made.energy_scale();
    let lost = |made: &Made, row: &Row| (row.energies.dashpots + row.energies.impacts) / made.energy_scale();
    let names: Vec<_> = made.iter().enumerate().map(|(look, made)| (look, made.name())).collect();
    let svg = page(8, caption, [1800, 56 + 1300], |root, body| {
        let (key, body) = body.split_vertically(56);
        keys(&key, &names)?;
        let areas = body.split_evenly((2, 1));
        let values: [(&str, Value); 2] = [("energy", total), ("taken by dashpots and impacts", lost)];
        for (area, (name, value)) in areas.iter().zip(values) {
            let span = range(made.iter().flat_map(|made| made.history.rows.iter().map(move |row| value(made, row))));
            let curves = made.iter().enumerate().map(|(look, made)| made.curve(look, |row| value(made, row))).collect();
            let chart = Chart { title: String::new(), x: ("t (s)", 0.0..HISTORY_DURATION), y: (name, span), curves };
            chart.draw(root, area)?;
        }
        Ok(())
    })?;
    Ok(svg)
}
