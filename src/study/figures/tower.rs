//! Figure 14: peak rotations of the bridge tower on supports of all stiffnesses.

use plotters::prelude::*;

use crate::block::BlockError;
use crate::simulation::{Initial, Settings};
use crate::study::figures::page::{Area, Drawn, page, text};
use crate::study::figures::parameters::{TOWER_ALPHA, TOWER_ETA, TOWER_P, TOWER_SUPPORT, block};
use crate::study::figures::sources::Source;
use crate::study::figures::table::Table;
use crate::study::figures::{Figure, FigureError, Work};
use crate::study::history::Run;
use crate::study::outcome::{End, Outcome};
use crate::study::plot::{GRID, INK, LEFT, short};
use crate::study::spectrum::Base;

const BARS: usize = 1 + TOWER_ETA.len();
/// Width of a bar (pixels).
const BAR: i32 = 64;

/// What a bar stands on, the rigid base last.
fn base(bar: usize) -> Base {
    let [xi_v, epsilon] = TOWER_SUPPORT;
    let rigid = Base::Rigid { epsilon, restitution_factor: 1.0 };
    TOWER_ETA.get(bar).map_or(rigid, |&eta| Base::Viscoelastic { eta, xi_v, epsilon })
}

/// The run of the tower on a foundation under a ground motion.
pub fn tower_run(base: Base, source: &Source) -> Result<Run, BlockError> {
    let block = block(TOWER_ALPHA, TOWER_P, base)?;
    let Source { ground, pulse, .. } = source;
    Ok(Run {
        block,
        settings: Settings::default(),
        initial: Initial::default(),
        pulse: *pulse,
        ground: ground.clone(),
        duration: None,
        output_step: ground.time_step().unwrap_or(0.01),
    })
}

/// Peak |θ|/α of a block that stands, or what became of it.
fn drawn(outcome: &Outcome, alpha: f64) -> String {
    match outcome.end {
        End::Completed => (outcome.peaks.theta / alpha).to_string(),
        End::Overturned | End::Separated | End::Failed => outcome.end.to_string(),
    }
}

/// How many runs the figure has.
pub fn tasks(sources: &[Source]) -> u64 {
    (sources.len() * BARS) as u64
}

/// Makes the figure.
pub fn figure(caption: &str, sources: &[Source], work: &mut Work) -> Result<Figure, FigureError> {
    let sources: Vec<Source> = sources.iter().map(Source::horizontal_only).collect();
    let outcomes = work.make(tasks(&sources), |task| -> Result<_, BlockError> {
        let run = tower_run(base(task as usize % BARS), &sources[task as usize / BARS])?;
        let outcome = run.outcome();
        Ok((drawn(&outcome, run.block.alpha), outcome.end_time.to_string(), outcome.end == End::Failed))
    });
    let lines: Vec<String> = sources.iter().map(|source| format!("motion {}: {}", source.name, source.label)).collect();
    let columns = ["motion", "foundation", "peak.theta/alpha", "end_time"];
    let mut table = Table::new(14, caption, &lines, &columns)?;
    let (mut bars, mut failed) = (Vec::new(), 0);
    for (task, made) in outcomes.into_iter().enumerate() {
        let (rotation, end_time, has_failed) = made?;
        failed += u64::from(has_failed);
        let motion = sources[task / BARS].name.to_string();
        table.push([motion, base(task % BARS).to_string(), rotation.clone(), end_time])?;
        bars.push(rotation);
    }
    let svg = page(14, caption, [2000, 1200], |_, body| draw(body, &sources, &bars))?;
    Ok(Figure { number: 14, svg, table: table.finish()?, failed })
}

fn draw(area: &Area, sources: &[Source], bars: &[String]) -> Drawn {
    let (width, height) = area.dim_in_pixel();
    let (left, bottom, top) = (LEFT as i32 + 16, height as i32 - 40 * sources.len() as i32 - 80, 110);
    let mut x = left;
    for bar in 0..BARS {
        fill(area, bar, (x, 20), (x + 60, 56))?;
        let name = TOWER_ETA.get(bar).map_or("rigid base".into(), |eta| format!("η = {}", short(*eta)));
        area.draw_text(&name, &text(26), (x + 74, 24))?;
        x += 250;
    }
    let values = bars.iter().filter_map(|bar| bar.parse::<f64>().ok());
    let highest = 1.1 * values.fold(0.0_f64, f64::max).max(1e-9);
    let y = |value: f64| bottom - (value / highest * f64::from(bottom - top)) as i32;
    let step = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5].into_iter().find(|step| highest / step < 10.0).unwrap_or(1.0);
    for i in 0..=(highest / step) as u32 {
        let value = f64::from(i) * step;
        area.draw(&PathElement::new(vec![(left, y(value)), (width as i32 - 40, y(value))], GRID.stroke_width(2)))?;
        area.draw_text(&short(value), &text(24), (left - 76, y(value) - 14))?;
    }
    area.draw_text("peak |θ| / α", &text(26).transform(FontTransform::Rotate270), (28, (top + bottom) / 2 + 80))?;
    let room = (width as i32 - 40 - left) / sources.len().max(1) as i32;
    for (group, (source, bars)) in sources.iter().zip(bars.chunks(BARS)).enumerate() {
        let from = left + room * group as i32 + (room - BAR * BARS as i32) / 2;
        for (bar, rotation) in bars.iter().enumerate() {
            let x = from + BAR * bar as i32;
            match rotation.parse::<f64>() {
                Ok(value) => {
                    fill(area, bar, (x + 3, y(value)), (x + BAR - 3, bottom))?;
                    area.draw_text(&format!("{value:.3}"), &text(20), (x + 4, y(value) - 26))?;
                }
                // No peak rotation: the word stands where the bar would.
                Err(_) => {
                    let upright = text(24).transform(FontTransform::Rotate270);
                    area.draw_text(rotation, &upright, (x + BAR / 2 - 12, bottom - 12))?;
                }
            }
        }
        let number = (b'a' + group as u8) as char;
        area.draw_text(&format!("({number})"), &text(26), (from + BAR * BARS as i32 / 2 - 16, bottom + 12))?;
        let line = bottom + 60 + 40 * group as i32;
        area.draw_text(&format!("({number}) {}", source.label), &text(26), (left, line))?;
    }
    area.draw(&PathElement::new(vec![(left, top), (left, bottom), (width as i32 - 40, bottom)], INK.stroke_width(2)))?;
    Ok(())
}

/// A bar, told from the others by its filling: white, stripes, greys, black.
fn fill(area: &Area, bar: usize, from: (i32, i32), to: (i32, i32)) -> Drawn {
    let grey = |level: u8| RGBColor(level, level, level).filled();
    let filling = [grey(255), grey(255), grey(215), grey(255), grey(150), INK.filled()][bar % 6];
    area.draw(&Rectangle::new([from, to], filling))?;
    let line = |a: (i32, i32), b: (i32, i32)| PathElement::new(vec![a, b], INK.stroke_width(2));
    match bar % 6 {
        1 => (from.1..to.1).rev().step_by(9).try_for_each(|y| area.draw(&line((from.0, y), (to.0, y))))?,
        3 => (from.0..to.0).step_by(9).try_for_each(|x| area.draw(&line((x, from.1), (x, to.1))))?,
        _ => {}
    }
    area.draw(&Rectangle::new([from, to], INK.stroke_width(2)))?;
    Ok(())
}
