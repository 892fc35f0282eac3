//! The table of a sweep over levels → curves of incremental dynamic analysis.

use std::collections::BTreeMap;

use crate::fragility::table::{SweepTable, SweepTableError};
use crate::run::outcome::End;

/// The response of blocks to ground motions of increasing strength.
#[derive(Clone, Debug, PartialEq)]
pub struct Ida {
    /// Levels of the intensity measure at which fractiles are shown, increasing. They are those of all curves, or evenly spaced if the
    /// curves differ.
    pub levels: Vec<f64>,
    /// The curves, one per block and ground motion.
    pub curves: Vec<IdaCurve>,
}

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
    /// Returns the peak for ranking, infinite unless the block stands.
    fn rank(self) -> f64 {
        match self {
            Response::Stands(peak) => peak,
            Response::Overturns | Response::Unknown => f64::INFINITY,
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
    /// A missing column, or a row without a level.
    pub fn read(table: &SweepTable, im: &str) -> Result<Ida, SweepTableError> {
        let (measures, peaks) = (table.numbers(im)?, table.numbers("peak.theta/alpha")?);
        let ends = table.ends()?;
        let keys = table.fields_before("scale")?;
        let mut rows = Vec::new();
        for (row, ((level, peak), end)) in measures.into_iter().zip(peaks).zip(ends).enumerate() {
            let Some(level) = level else { return Err(table.no_level(row, im)) };
            rows.push((keys[row].clone(), level, peak, end));
        }
        Ok(Ida::of(rows))
    }

    /// Sorts rows into curves. Each row has block and ground motion, the level, the peak |θ|/α and the end of the run.
    pub fn of(rows: impl IntoIterator<Item = (String, f64, Option<f64>, End)>) -> Ida {
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
        Ida { levels: levels(&curves), curves }
    }

    /// Returns the fractile of the known responses at each level. It is the least one that this fraction does not exceed.
    pub fn fractile(&self, fraction: f64) -> Vec<Response> {
        let at = |&level: &f64| {
            let known = self.curves.iter().map(|curve| curve.at(level)).filter(|found| *found != Response::Unknown);
            let mut known: Vec<Response> = known.collect();
            known.sort_by(|a, b| a.rank().total_cmp(&b.rank()));
            known.get(rank(fraction, known.len())).copied().unwrap_or(Response::Unknown)
        };
        self.levels.iter().map(at).collect()
    }

    /// Returns the fractile over all curves of the least level that overturns. That is the middle between the level and the one below;
    /// `None` where this fraction of the curves does not overturn.
    pub fn overturning(&self, fraction: f64) -> Option<f64> {
        self.fractile_of_levels(fraction, |curve| curve.overturning().map(|[below, least]| 0.5 * (below + least)))
    }

    /// Returns the fractile over all curves of the first level that reaches the peak.
    pub fn reaching(&self, fraction: f64, peak: f64) -> Option<f64> {
        self.fractile_of_levels(fraction, |curve| curve.reaches(peak))
    }

    fn fractile_of_levels(&self, fraction: f64, of: impl Fn(&IdaCurve) -> Option<f64>) -> Option<f64> {
        let mut levels: Vec<f64> = self.curves.iter().map(|curve| of(curve).unwrap_or(f64::INFINITY)).collect();
        levels.sort_by(f64::total_cmp);
        levels.get(rank(fraction, levels.len())).copied().filter(|level| level.is_finite())
    }
}

/// Returns the position of a fractile in a sorted list of this length.
fn rank(fraction: f64, length: usize) -> usize {
    ((fraction * length as f64).ceil() as usize).saturating_sub(1)
}

/// Returns the levels that all curves share. Otherwise they are evenly spaced up to the greatest.
fn levels(curves: &[IdaCurve]) -> Vec<f64> {
    /// Number of evenly spaced levels.
    const EVEN: u32 = 100;
    let Some(first) = curves.first() else { return Vec::new() };
    let same = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * b.abs();
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

    /// Three records at two levels, in any order.
    #[test]
    fn fractiles_ignore_unknown_responses() {
        let head = "row,p [rad/s],record,vertical,scale [1],PGV [m/s],outcome,peak.theta/alpha [1]\n";
        let rows = "0,1,a,,1,0.5,completed,0.1\n1,1,a,,2,1.0000000000000002,overturned,9\n2,1,b,,3,0.5,completed,0.3\n\
                    3,1,b,,6,1,completed,0.9\n4,1,c,,1,1,failed,0.2\n5,1,c,,0.5,0.5,completed,0.2\n";
        let read =
            |rows: &str| Ida::read(&SweepTable::read("t.csv", format!("{head}{rows}").as_bytes()).unwrap(), "PGV");
        let ida = read(rows).unwrap();
        assert_eq!((ida.levels.len(), ida.curves.len()), (2, 3));
        assert_eq!(ida.fractile(0.16), [Response::Stands(0.1), Response::Stands(0.9)]);
        assert_eq!(ida.fractile(0.5), [Response::Stands(0.2), Response::Stands(0.9)]);
        assert_eq!(ida.fractile(0.84), [Response::Stands(0.3), Response::Overturns]);
        let near = |found: Option<f64>, expected: f64| found.is_some_and(|found| (found - expected).abs() < 1e-12);
        assert!(near(ida.overturning(0.16), 0.75) && ida.overturning(0.5).is_none());
        assert!(near(ida.curves[1].reaches(0.6), 0.75));
        let message = read(&rows.replace("3,0.5,completed", "3,,completed")).unwrap_err().to_string();
        assert!(message.contains("row 2 has PGV [m/s] = "), "{message}");
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
        ]);
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
        assert_eq!([ida.overturning(0.5), ida.overturning(0.84)], [Some(2.5), None]);
        assert_eq!(ida.reaching(0.84, 0.4), Some(2.0));
    }
}
