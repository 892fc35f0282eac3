//! The table of a sweep over levels → curves of incremental dynamic analysis.

use std::collections::BTreeMap;

use crate::fragility::table::{SweepTable, SweepTableError};
use crate::input::motion::MOTION;
use crate::intensity::Measure;
use crate::mismatch::Mismatch;
use crate::output::table::{Series, split_heading};
use crate::run::fatigue;
use crate::run::outcome::End;

/// The response of blocks to ground motions of increasing strength.
#[derive(Clone, Debug, PartialEq)]
pub struct Ida {
    /// Levels of the intensity measure at which fractiles are shown, increasing. They are those of all curves, or evenly spaced if the
    /// curves differ.
    pub levels: Vec<f64>,
    /// The curves, one per block and ground motion.
    pub curves: Vec<IdaCurve>,
    /// The rotation whose peaks they are: |θ|/α, or the tilt over that of the balance in space.
    pub rotation: &'static str,
    /// For each curve the least level at which a tie or damper breaks, if one does; `None` for blocks without either.
    pub breaks: Option<Vec<Option<f64>>>,
}

/// The rotation of blocks in the plane, and of those in space.
pub(super) const ROTATIONS: [&str; 2] = ["|θ|/α", "tilt over that of the balance"];

/// A row of a curve: block and ground motion, the level, the peak |θ|/α and the end of the run.
type CurveRow = (String, f64, Option<f64>, End);

/// The response of a block to a ground motion of increasing strength.
#[derive(Clone, Debug, PartialEq)]
pub struct IdaCurve {
    /// Block and ground motion, in the words of the table.
    pub name: String,
    /// The levels, increasing.
    pub levels: Vec<f64>,
    /// The responses at the levels.
    pub responses: Vec<Response>,
}

/// The response of a block at a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Response {
    /// Stands, with this peak |θ|/α (1).
    Stands(f64),
    /// Overturns: greater than any peak.
    Overturns,
    /// Unknown: the run failed, or ended at separation or undecided.
    Unknown,
}

impl Response {
    /// Returns the least and the greatest peak that the response may be, infinite where the block overturns.
    fn bounds(self) -> [f64; 2] {
        match self {
            Response::Stands(peak) => [peak; 2],
            Response::Overturns => [f64::INFINITY; 2],
            Response::Unknown => [0.0, f64::INFINITY],
        }
    }
}

impl IdaCurve {
    /// Returns the response at a level, linear between levels, from rest without shaking.
    ///
    /// Between a level that stands and a higher one that overturns, the block stands in the lower half. Beyond the last level it overturns if it
    /// does there; otherwise the response is unknown.
    pub fn at(&self, level: f64) -> Response {
        // A scaled record meets its level to round-off.
        let rounding = 1e-9 * level.abs();
        let above = self.levels.partition_point(|&known| known < level - rounding);
        let (Some(&end), Some(&after)) = (self.levels.get(above), self.responses.get(above)) else {
            return match self.responses.last() {
                Some(Response::Overturns) => Response::Overturns,
                Some(Response::Stands(_) | Response::Unknown) | None => Response::Unknown,
            };
        };
        if end <= level + rounding {
            return after;
        }
        let before = above.checked_sub(1);
        let (start, first) = before.map_or((0.0, Response::Stands(0.0)), |i| (self.levels[i], self.responses[i]));
        let fraction = (level - start) / (end - start);
        match (first, after) {
            (Response::Stands(low), Response::Stands(high)) => Response::Stands(low + fraction * (high - low)),
            (Response::Stands(low), Response::Overturns) if fraction < 0.5 => Response::Stands(low),
            (Response::Stands(_) | Response::Overturns, Response::Overturns) => Response::Overturns,
            (Response::Overturns, Response::Stands(_)) => Response::Overturns,
            (Response::Unknown, _) | (_, Response::Unknown) => Response::Unknown,
        }
    }

    /// Returns the least and the greatest value of the middle between the least level that overturns the block and the level below, over
    /// all outcomes of unknown runs. A block that stands at its last level overturns above it, if at all.
    fn overturning_bounds(&self) -> [f64; 2] {
        let middle =
            |level: usize| 0.5 * (level.checked_sub(1).map_or(0.0, |below| self.levels[below]) + self.levels[level]);
        let first = |found: fn(&Response) -> bool| self.responses.iter().position(found);
        let last = self.levels.last().copied().unwrap_or(0.0);
        let low = first(|response| !matches!(response, Response::Stands(_))).map_or(last, middle);
        [low, first(|response| *response == Response::Overturns).map_or(f64::INFINITY, middle)]
    }

    /// Returns the least and the greatest level that may be the first one at which the peak reaches this one, or the block overturns.
    fn reaching_bounds(&self, peak: f64) -> [f64; 2] {
        let last = self.levels.last().copied().unwrap_or(0.0);
        let high = self.reaches(peak).unwrap_or(f64::INFINITY);
        // An unknown run may reach the peak anywhere above the level below.
        let unknown = self.responses.iter().position(|response| *response == Response::Unknown);
        let below = unknown.map_or(last, |level| level.checked_sub(1).map_or(0.0, |below| self.levels[below]));
        [below.min(high), high]
    }

    /// Returns the least level that overturns the block, and the level below, 0 without any.
    pub fn overturning(&self) -> Option<[f64; 2]> {
        let least = self.responses.iter().position(|response| *response == Response::Overturns)?;
        Some([least.checked_sub(1).map_or(0.0, |below| self.levels[below]), self.levels[least]])
    }

    /// Returns the first level at which the peak reaches this one, or the block overturns. `None` if neither happens.
    pub fn reaches(&self, peak: f64) -> Option<f64> {
        let mut last = Some((0.0, 0.0));
        for (&level, &response) in self.levels.iter().zip(&self.responses) {
            match (last, response) {
                (Some((start, low)), Response::Stands(high)) if high >= peak => {
                    return Some(start + (peak - low) / (high - low) * (level - start));
                }
                (Some((start, _)), Response::Overturns) => return Some(0.5 * (start + level)),
                (None, Response::Stands(high)) if high >= peak => return Some(level),
                (None, Response::Overturns) => return Some(level),
                (_, Response::Stands(high)) => last = Some((level, high)),
                (_, Response::Unknown) => last = None,
            }
        }
        None
    }
}

impl Ida {
    /// Reads the curves from a table of `levels` or of a `hunt` for a measure.
    ///
    /// # Errors
    /// A missing column, a row without a level, or those of [`Ida::of`].
    pub fn read(table: &SweepTable, im: &str) -> Result<Ida, SweepTableError> {
        let (measures, peaks) = (table.numbers(im)?, table.numbers(table.rotation())?);
        let ends = table.ends()?;
        let described = table.table.columns().iter().filter(|column| describes_curve(&column.heading.name, im));
        let text = |column: &Series| (0..table.rows()).map(|row| column.text(row)).collect();
        let described: Vec<_> = described.map(|column| (column.heading.name.clone(), text(column))).collect();
        let names = curve_names(&described, table.rows()).map_err(|error| table.refused(error.to_string()))?;
        let broken = table.numbers("ties.broken").ok();
        let mut rows = Vec::new();
        for (row, ((level, peak), end)) in measures.into_iter().zip(peaks).zip(ends).enumerate() {
            let Some(level) = level else { return Err(table.no_level(row, im)) };
            rows.push((names[row].clone(), level, peak, end));
        }
        let broken = broken.map(|broken| {
            let breaks =
                |((name, level, ..), count): (&CurveRow, Option<f64>)| (name.clone(), *level, count > Some(0.0));
            rows.iter().zip(broken).map(breaks).collect::<Vec<_>>()
        });
        let mut found = Ida::of(rows).map_err(|error| table.refused(error.to_string()))?;
        if let Some(rows) = broken {
            found.mark_breaks(rows);
        }
        Ok(Ida { rotation: ROTATIONS[usize::from(table.is_in_space())], ..found })
    }

    /// Sorts rows into curves. Each row has block and ground motion, the level, the peak |θ|/α and the end of the run.
    ///
    /// # Errors
    /// Two rows of a curve at one level, or several levels without a curve that has two.
    pub fn of(rows: impl IntoIterator<Item = CurveRow>) -> Result<Ida, Mismatch> {
        let mut found: BTreeMap<String, Vec<(f64, Response)>> = BTreeMap::new();
        for (key, level, peak, end) in rows {
            let response = match (end, peak) {
                (End::Completed, Some(peak)) => Response::Stands(peak),
                (End::Overturned, _) => Response::Overturns,
                (End::Completed | End::Separated | End::Undecided | End::Failed, _) => Response::Unknown,
            };
            found.entry(key).or_default().push((level, response));
        }
        let curve = |(name, mut points): (String, Vec<(f64, Response)>)| {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (levels, responses) = points.into_iter().unzip();
            IdaCurve { name, levels, responses }
        };
        let curves: Vec<IdaCurve> = found.into_iter().map(curve).collect();
        for IdaCurve { name, levels, .. } in &curves {
            if let Some(pair) = levels.windows(2).find(|pair| is_same(pair[0], pair[1])) {
                let found = format!("two rows of the curve `{name}` at the level {}", pair[1]);
                return Err(Mismatch::new(found, "one, or a column that tells their blocks or ground motions apart"));
            }
        }
        let differ = |curve: &IdaCurve| !is_same(curve.levels[0], curves[0].levels[0]);
        if curves.iter().all(|curve| curve.levels.len() == 1) && curves.iter().any(differ) {
            let found = format!("a single level in each of {} curves, as of `{}`", curves.len(), curves[0].name);
            return Err(Mismatch::new(found, "several levels of each block and ground motion"));
        }
        Ok(Ida { levels: levels(&curves), curves, rotation: ROTATIONS[0], breaks: None })
    }

    /// Takes note of the rows of its curves, each with its level, in which a tie or damper breaks.
    pub fn mark_breaks(&mut self, rows: impl IntoIterator<Item = (String, f64, bool)>) {
        let mut least: BTreeMap<String, f64> = BTreeMap::new();
        for (name, level, _) in rows.into_iter().filter(|(.., breaks)| *breaks) {
            least.entry(name).and_modify(|least| *least = least.min(level)).or_insert(level);
        }
        self.breaks = Some(self.curves.iter().map(|curve| least.get(&curve.name).copied()).collect());
    }

    /// Returns the fractile of the responses of all curves at each level: the least one that this fraction of the curves does not exceed.
    ///
    /// It is known where all outcomes of the unknown responses give the same one. At such a level a curve without a run, beyond its last
    /// one that stands, or with an undecided or failed run, may have any peak or overturn.
    pub fn fractile(&self, fraction: f64) -> Vec<Response> {
        let at = |&level: &f64| match fractile(fraction, self.curves.iter().map(|curve| curve.at(level).bounds())) {
            [low, high] if low != high => Response::Unknown,
            [peak, _] if peak.is_finite() => Response::Stands(peak),
            _ => Response::Overturns,
        };
        self.levels.iter().map(at).collect()
    }

    /// Returns the fractile over all curves of the least level that overturns: the least and the greatest value that it has over all
    /// outcomes of unknown responses. For a curve the level is the middle between it and the one below.
    ///
    /// A curve that stands at its last level has any level above. The fractile is known where both values are the same; the greatest is
    /// infinite where this fraction of the curves may never overturn.
    pub fn overturning(&self, fraction: f64) -> [f64; 2] {
        fractile(fraction, self.curves.iter().map(IdaCurve::overturning_bounds))
    }

    /// Returns the level from which the [`Ida::fractile`] of the peak overturns: the least and the greatest value, as [`Ida::overturning`].
    /// The greater the fraction of curves that it bounds, the lower the level.
    pub fn fractile_overturns(&self, fraction: f64) -> [f64; 2] {
        // Curves in the order of their peaks at a level: that of the fractile overturns with all after it.
        let after = self.curves.len().saturating_sub(1 + rank(fraction, self.curves.len()));
        order_statistic(after, self.curves.iter().map(IdaCurve::overturning_bounds))
    }

    /// Returns the fractile over all curves of the first level that reaches the peak, as [`Ida::overturning`].
    pub fn reaching(&self, fraction: f64, peak: f64) -> [f64; 2] {
        fractile(fraction, self.curves.iter().map(|curve| curve.reaching_bounds(peak)))
    }
}

/// Returns the position of a fractile in a sorted list of this length: the first number that this fraction of all does not exceed.
fn rank(fraction: f64, length: usize) -> usize {
    ((fraction * length as f64).ceil() as usize).saturating_sub(1)
}

/// Returns the least and the greatest value of a fractile of numbers between these bounds.
fn fractile(fraction: f64, bounds: impl ExactSizeIterator<Item = [f64; 2]>) -> [f64; 2] {
    order_statistic(rank(fraction, bounds.len()), bounds)
}

/// Returns the least and the greatest value of the number of this rank, from 0, among numbers between these bounds. Without numbers it may
/// be any.
fn order_statistic(rank: usize, bounds: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    let (mut lows, mut highs): (Vec<f64>, Vec<f64>) = bounds.map(|[low, high]| (low, high)).unzip();
    [&mut lows, &mut highs].iter_mut().for_each(|ends| ends.sort_by(f64::total_cmp));
    match lows.get(rank).zip(highs.get(rank)) {
        // Levels of several records that are one to round-off.
        Some((low, high)) if high.is_finite() && is_same(*low, *high) => [*low; 2],
        Some((low, high)) => [*low, *high],
        None => [0.0, f64::INFINITY],
    }
}

/// Whether two levels are one: a scaled record meets its level to round-off.
fn is_same(one: f64, other: f64) -> bool {
    (one - other).abs() <= 1e-9 * other.abs()
}

/// Whether a column describes the block or the ground motion of a row, rather than the strength of the motion or the response. `im` is the
/// measure of the levels. Columns of unknown names describe, such as the keys of folders.
fn describes_curve(column: &str, im: &str) -> bool {
    /// The number of a row, the motion of its record, factors on it, and results.
    const OTHERS: [&str; 12] = [
        "row",
        MOTION,
        "scale",
        "PGA.vertical",
        "outcome",
        "end_time",
        "first_separation",
        "first_break",
        "flights",
        "ties.broken",
        "overturning_ranges",
        "separated",
    ];
    /// Results that occur more than once.
    const RESULTS: [&str; 10] = [
        "peak.",
        "end.",
        "events.",
        "ensemble.",
        "P(",
        "least.",
        "always_from.",
        "overturning.",
        "friction_demand>",
        fatigue::COLUMN,
    ];
    !OTHERS.contains(&column)
        && !RESULTS.iter().any(|result| column.starts_with(result))
        && column.parse::<Measure>().is_err()
        && column != split_heading(im).0
}

/// Returns the name of the curve of each row: the values of its describing columns that vary, those of records alone.
///
/// # Errors
/// No column describes the rows.
fn curve_names(described: &[(String, Vec<String>)], rows: usize) -> Result<Vec<String>, Mismatch> {
    let Some(first) = described.first() else {
        return Err(Mismatch::new("no column that names the ground motion", "a column such as record"));
    };
    let varies = |(_, values): &&(String, Vec<String>)| values.iter().any(|value| *value != values[0]);
    let mut varying: Vec<_> = described.iter().filter(varies).collect();
    if varying.is_empty() {
        varying.push(first);
    }
    let part = |(name, values): &(String, Vec<String>), row: usize| match name.as_str() {
        "record" | "record_y" | "vertical" => values[row].clone(),
        name => format!("{name} = {}", values[row]),
    };
    let name = |row: usize| varying.iter().map(|column| part(column, row)).collect::<Vec<_>>().join(", ");
    Ok((0..rows).map(name).collect())
}

/// Returns the levels that all curves share. Otherwise they are evenly spaced up to the greatest.
fn levels(curves: &[IdaCurve]) -> Vec<f64> {
    /// Number of evenly spaced levels.
    const EVEN: u32 = 100;
    let Some(first) = curves.first() else { return Vec::new() };
    let same = |(a, b): (&f64, &f64)| is_same(*a, *b);
    let fits =
        |curve: &IdaCurve| curve.levels.len() == first.levels.len() && curve.levels.iter().zip(&first.levels).all(same);
    if curves.iter().all(fits) {
        return first.levels.clone();
    }
    let greatest = curves.iter().filter_map(|curve| curve.levels.last()).copied().fold(0.0, f64::max);
    (1..=EVEN).map(|level| greatest * f64::from(level) / f64::from(EVEN)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three records at two levels, in any order. One run fails at the second.
    #[test]
    fn fractiles_are_unknown_where_too_few_responses_are_known() {
        let head = "row,p [rad/s],record,vertical,scale [1],PGV [m/s],outcome,peak.theta/alpha [1]\n";
        let rows = "0,1,a,,1,0.5,completed,0.1\n1,1,a,,2,1.0000000000000002,overturned,9\n2,1,b,,3,0.5,completed,0.3\n\
                    3,1,b,,6,1,completed,0.9\n4,1,c,,1,1,failed,0.2\n5,1,c,,0.5,0.5,completed,0.2\n";
        let read =
            |rows: &str| Ida::read(&SweepTable::read("t.csv", format!("{head}{rows}").as_bytes()).unwrap(), "PGV");
        let ida = read(rows).unwrap();
        assert_eq!((ida.levels.len(), ida.curves.len()), (2, 3));
        assert_eq!(ida.fractile(0.16), [Response::Stands(0.1), Response::Unknown]);
        assert_eq!(ida.fractile(0.5), [Response::Stands(0.2), Response::Unknown]);
        assert_eq!(ida.fractile(0.84), [Response::Stands(0.3), Response::Overturns]);
        assert_eq!(ida.overturning(0.16), [0.75; 2]);
        let [[low, high], last] = [0.5, 0.84].map(|fraction| ida.overturning(fraction));
        assert!(is_same(low, 0.75) && high == f64::INFINITY && last == [1.0, f64::INFINITY], "{low} {high} {last:?}");
        assert!((ida.curves[1].reaches(0.6).unwrap() - 0.75).abs() < 1e-12);
        let message = read(&rows.replace("3,0.5,completed", "3,,completed")).unwrap_err().to_string();
        assert!(message.contains("row 2 has PGV [m/s] = "), "{message}");
    }

    /// Curves that end standing or undecided leave no fractile known that depends on them, in any of their completions.
    #[test]
    fn curves_without_an_outcome_may_have_any() {
        let ida = |curves: &[&[(f64, End)]]| {
            let rows = curves.iter().enumerate().flat_map(|(number, points)| {
                points.iter().map(move |&(level, end)| (number.to_string(), level, Some(0.1 * level), end))
            });
            Ida::of(rows).unwrap()
        };
        let (stands, falls, open) = (End::Completed, End::Overturned, End::Undecided);
        // Two of three stand at their last level, below the one at which the third overturns.
        let found = ida(&[&[(1.0, stands)], &[(1.0, stands)], &[(1.0, stands), (2.0, falls)]]);
        let at_last = |fraction: f64| *found.fractile(fraction).last().unwrap();
        assert_eq!([0.16, 0.5, 0.84].map(at_last), [Response::Unknown, Response::Unknown, Response::Overturns]);
        assert_eq!(found.overturning(0.5), [1.0, f64::INFINITY]);
        // The greatest fractile of the peak is that of the curve that overturns first.
        assert_eq!([0.84, 0.16].map(|fraction| found.fractile_overturns(fraction)), [[1.0, 1.5], [1.5, f64::INFINITY]]);
        // Three of four are undecided: their least levels may lie below that of the fourth.
        let found = ida(&[&[(1.0, open)], &[(1.0, open)], &[(1.0, open)], &[(1.0, falls)]]);
        assert_eq!(
            [0.16, 0.5, 0.84].map(|fraction| found.fractile(fraction)[0]),
            [Response::Unknown, Response::Unknown, Response::Overturns]
        );
        assert_eq!([0.16, 0.84].map(|fraction| found.overturning(fraction)), [[0.5; 2], [0.5, f64::INFINITY]]);
        // An undecided run may reach a peak above the level below it.
        let found = ida(&[&[(1.0, stands), (2.0, open), (3.0, falls)]]);
        assert_eq!((found.reaching(0.5, 0.05), found.reaching(0.5, 0.2)), ([0.5; 2], [1.0, 3.0]));
        assert_eq!(found.overturning(0.5), [1.5, 2.5]);
    }

    /// Tables have the number of a row first, in files, and the keys of folders last.
    #[test]
    fn curves_are_told_apart_by_block_and_motion_alone() {
        let read = |table: &str| Ida::read(&SweepTable::read("t.csv", table.as_bytes()).unwrap(), "PGV");
        let table = "row,record,scale [1],PGV [m/s],outcome,peak.theta/alpha [1],run\n0,a,1,0.5,completed,0.1,1\n\
                     1,a,2,1,overturned,9,1\n2,a,1,0.5,completed,0.2,2\n3,a,2,1,completed,0.4,2\n";
        let names: Vec<String> = read(table).unwrap().curves.into_iter().map(|curve| curve.name).collect();
        assert_eq!(names, ["run = 1", "run = 2"]);
        let without: String = table.lines().map(|line| line.rsplit_once(',').unwrap().0.to_string() + "\n").collect();
        let message = read(&without).unwrap_err().to_string();
        assert!(message.contains("two rows of the curve `a` at the level 0.5; expected one"), "{message}");
        let note = table.replace(",run\n", ",note\n").replace(",1,1\n", ",1,3\n").replace("9,1\n", "9,4\n");
        let note = note.replace("0.1,1\n", "0.1,5\n").replace("0.4,2\n", "0.4,6\n");
        let message = read(&note).unwrap_err().to_string();
        assert!(message.contains("a single level in each of 4 curves, as of `note = 2`"), "{message}");
    }

    /// No result of any study describes a curve.
    #[test]
    fn results_describe_no_curve() {
        use crate::run::outcome::{Holds, Outcome, columns};
        let holds = Holds { friction: true, ties: 2, dampers: 2, yields: true };
        for column in columns(holds, |row: &Outcome| row) {
            let name = &column.heading().name;
            assert!(!describes_curve(name, "PGV"), "{name}");
        }
        for column in crate::space::outcome::columns(|row: &crate::space::outcome::OutcomeInSpace| row) {
            let name = &column.heading().name;
            assert!(!describes_curve(name, "PGV.RotD50"), "{name}");
        }
        assert!(
            ["record", "record_y", "vertical", "azimuth", "floor", "alpha", "run"]
                .iter()
                .all(|name| describes_curve(name, "PGV"))
        );
    }

    /// Curves with levels of their own are linear between them, and end where they overturn.
    #[test]
    fn curves_of_a_hunt_are_compared_between_their_levels() {
        let row = |key: &str, level: f64, peak: f64, end| (key.to_string(), level, Some(peak), end);
        let ida = Ida::of([
            row("a", 1.0, 0.2, End::Completed),
            row("a", 2.0, 0.6, End::Completed),
            row("a", 3.0, 9.0, End::Overturned),
            row("b", 4.0, 0.8, End::Completed),
        ])
        .unwrap();
        let [a, b] = &ida.curves[..] else { panic!("{ida:?}") };
        assert_eq!(
            [0.5, 1.5, 2.4, 2.6, 5.0].map(|level| a.at(level)),
            [
                Response::Stands(0.1),
                Response::Stands(0.4),
                Response::Stands(0.6),
                Response::Overturns,
                Response::Overturns,
            ]
        );
        assert_eq!([b.at(1.0), b.at(4.5)], [Response::Stands(0.2), Response::Unknown]);
        assert_eq!((a.overturning(), b.overturning()), (Some([2.0, 3.0]), None));
        assert_eq!(
            [a.reaches(0.4), a.reaches(0.9), b.reaches(0.4), b.reaches(0.9)],
            [Some(1.5), Some(2.5), Some(2.0), None]
        );
        assert_eq!((ida.levels.len(), ida.levels[99]), (100, 4.0));
        // At 2.5 one overturns; the other has 0.5.
        assert_eq!(ida.fractile(0.5)[62], Response::Stands(0.8 * 2.52 / 4.0));
        assert_eq!(ida.fractile(0.84)[62], Response::Overturns);
        assert_eq!([ida.overturning(0.5), ida.overturning(0.84)], [[2.5; 2], [4.0, f64::INFINITY]]);
        assert_eq!(ida.reaching(0.84, 0.4), [2.0; 2]);
    }
}
