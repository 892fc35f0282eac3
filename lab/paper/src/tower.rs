//! Figure 14: peak rotations of the bridge tower on supports of several stiffnesses.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::figure::{self, Figure, FigureError, page};
use crate::ground_motions::GroundMotion;
use crate::parameters::{PAD_ETA, TOWER_ALPHA, TOWER_ETA, TOWER_P, TOWER_SUPPORT, block, run};
use rocking_block::block::BlockError;
use rocking_charts::canvas::{Area, Drawn, INK, TEXT, anchored, fill, grey, outline, text};
use rocking_charts::chart::set_mesh_style;
use rocking_charts::formula::formula;
use rocking_charts::line_style::LineStyle;
use rocking_charts::numerals::{short, tick};
use rocking_charts::page::Symbol;
use rocking_studies::output::runner::in_parallel;
use rocking_studies::output::table::TableColumn;
use rocking_studies::run::Run;
use rocking_studies::run::outcome::{self, End, Holds, Outcome};
use rocking_studies::spectrum::FoundationCurve;

/// Returns the foundations of the tower: supports, rigid base and pads. The pads are in the table only.
pub fn tower_bases() -> Vec<FoundationCurve> {
    let [xi_v, epsilon] = TOWER_SUPPORT;
    let support = |eta: f64| FoundationCurve::viscoelastic(eta, xi_v, epsilon);
    let rigid = FoundationCurve::rigid(epsilon, 1.0);
    TOWER_ETA.map(support).into_iter().chain([rigid]).chain(PAD_ETA.map(support)).collect()
}

/// Returns the horizontal ground motions in the order of the paper's peak ground accelerations.
pub fn tower_sources(sources: &[GroundMotion]) -> Vec<GroundMotion> {
    let mut sources: Vec<GroundMotion> = sources.iter().map(GroundMotion::horizontal_only).collect();
    sources.sort_by(|a, b| a.pga.total_cmp(&b.pga));
    sources
}

/// Returns the run of the tower on a foundation under a ground motion.
///
/// # Errors
/// An invalid block.
pub fn tower_run(base: FoundationCurve, source: &GroundMotion) -> Result<Run, BlockError> {
    Ok(run(block(TOWER_ALPHA, TOWER_P, base)?, source.pulse, source.ground.clone()))
}

/// Makes the figure.
pub fn figure(sources: &[GroundMotion]) -> Result<Figure, FigureError> {
    let (sources, bases) = (tower_sources(sources), tower_bases());
    let outcomes = in_parallel(sources.len() * bases.len(), |task| -> Result<Outcome, BlockError> {
        let run = tower_run(bases[task % bases.len()], &sources[task / bases.len()])?;
        Ok(run.outcome())
    });
    let outcomes = outcomes.into_iter().collect::<Result<Vec<_>, _>>()?;
    let lines: Vec<String> = sources.iter().map(|source| format!("motion {}: {}", source.name, source.label)).collect();
    let columns = columns(&sources, &bases);
    let rows: Vec<TowerRow> = outcomes.iter().enumerate().collect();
    let bars = GREYS.into_iter().zip(TOWER_ETA);
    let mut legend: Vec<_> = bars.map(|(grey, eta)| (Symbol::Grey(grey), format!("η = {}", short(eta)))).collect();
    legend.push((Symbol::Curve(LineStyle::DASH_DOTTED), "rigid base".into()));
    let groups: Vec<&[Outcome]> = outcomes.chunks(bases.len()).collect();
    let svg = page(14, &legend, 12_200, |root, body| draw(root, body, &sources, &groups))?;
    let failed = outcomes.iter().filter(|outcome| outcome.end == End::Failed).count() as u64;
    Ok(Figure { failed, ..figure::figure(14, &lines, &columns, &rows, svg)? })
}

/// The number of a task and its outcome.
type TowerRow<'a> = (usize, &'a Outcome);

/// Returns the columns of the table.
fn columns<'a>(sources: &[GroundMotion], bases: &'a [FoundationCurve]) -> Vec<TableColumn<'a, TowerRow<'a>>> {
    let motion =
        TableColumn::choice("motion", sources.iter().map(|source| source.name), |row: &TowerRow| row.0 / bases.len());
    let names = bases.iter().map(ToString::to_string);
    let foundation = TableColumn::choice("foundation", names, |row: &TowerRow| row.0 % bases.len());
    [motion, foundation].into_iter().chain(outcome::columns(Holds::default(), |row: &TowerRow| row.1)).collect()
}

/// Grey levels of the bars.
const GREYS: [u8; TOWER_ETA.len()] = [255, 190, 90];

/// Draws a group of bars per ground motion, with outcomes in the order of [`tower_bases`].
fn draw(root: &Area, area: &Area, sources: &[GroundMotion], groups: &[&[Outcome]]) -> Drawn {
    const LINE: i32 = 500;
    let (body, under) = area.split_vertically(area.dim_in_pixel().1 - (LINE as u32) * (sources.len() as u32 + 2));
    let standing = groups.iter().flat_map(|group| group.iter()).filter(|outcome| outcome.end == End::Completed);
    let peaks = standing.map(|outcome| outcome.peaks.theta / TOWER_ALPHA);
    let highest = 1.12 * peaks.fold(1e-9, f64::max);
    let mut chart = ChartBuilder::on(&body)
        .margin_right(800)
        .margin_left(240)
        .margin_top(100)
        .set_label_area_size(LabelAreaPosition::Left, 1560)
        .build_cartesian_2d(0.0..sources.len() as f64, 0.0..highest)?;
    let ordinate = |y: &f64| tick(*y, &(0.0..highest));
    let mut mesh = chart.configure_mesh();
    set_mesh_style(&mut mesh);
    mesh.disable_x_mesh().disable_x_axis().y_desc("peak |θ|/α").y_labels(8).y_label_formatter(&ordinate).draw()?;
    let (left, top) = under.get_base_pixel();
    for (i, (source, group)) in sources.iter().zip(groups).enumerate() {
        let (bars, others) = group.split_at(TOWER_ETA.len());
        for (bar, outcome) in bars.iter().enumerate() {
            let from = i as f64 + 0.17 + 0.22 * bar as f64;
            let (middle, value) = (from + 0.11, outcome.peaks.theta / TOWER_ALPHA);
            match outcome.end {
                End::Completed => {
                    let corners = [(from, 0.0), (from + 0.22, value)].map(|corner| chart.backend_coord(&corner));
                    fill(root, corners, grey(GREYS[bar]))?;
                    outline(root, corners, 40)?;
                    // At the foot of the bar no line is in the way.
                    let (x, y) = chart.backend_coord(&(middle, 0.0));
                    let ink = if GREYS[bar] < 128 { WHITE } else { INK };
                    let style = anchored(0.8 * TEXT, HPos::Center, VPos::Bottom).color(&ink);
                    root.draw_text(&format!("{value:.3}"), &style, (x, y - 160))?;
                }
                // Without a peak rotation the outcome replaces the bar.
                End::Overturned | End::Separated | End::Undecided | End::Failed => {
                    let (x, y) = chart.backend_coord(&(middle, 0.0));
                    let upright = text(TEXT).transform(FontTransform::Rotate270);
                    root.draw_text(outcome.end.word(), &upright, (x - 200, y - 200))?;
                }
            }
        }
        if let Some(rigid) = others.first().filter(|outcome| outcome.end == End::Completed) {
            let value = rigid.peaks.theta / TOWER_ALPHA;
            let ends = [i as f64 + 0.1, i as f64 + 0.9].map(|x| chart.backend_coord(&(x, value)));
            LineStyle::DASH_DOTTED.draw(root, &ends)?;
            let beside = anchored(0.8 * TEXT, HPos::Left, VPos::Center);
            root.draw_text(&format!("{value:.3}"), &beside, (ends[1].0 + 60, ends[1].1))?;
        }
        let letter = (b'a' + i as u8) as char;
        let (x, _) = chart.backend_coord(&(i as f64 + 0.5, 0.0));
        let station = format!("({letter}) PGA {:.2} g", source.pga);
        root.draw_text(&station, &anchored(TEXT, HPos::Center, VPos::Top), (x, top + 140))?;
        let line = format!("({letter}) {}", source.label);
        root.draw_text(&formula(&line), &text(TEXT), (left + 1800, top + LINE * (i as i32 + 2) - 200))?;
    }
    Ok(())
}
