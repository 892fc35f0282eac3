//! The table of a sweep over levels → curves of incremental dynamic analysis.

use std::collections::BTreeMap;

use crate::fragility::table::{SweepTable, SweepTableError};
use crate::run::outcome::End;

/// The response of blocks to ground motions of increasing strength.
#[derive(Clone, Debug, PartialEq)]
pub struct Ida {
    /// The levels of the intensity measure, increasing.
    pub levels: Vec<f64>,
    /// The responses at the levels, one curve per block and ground motion.
    pub curves: Vec<Vec<Response>>,
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

impl Ida {
    /// Reads the curves from a table of `levels` of a measure.
    ///
    /// # Errors
    /// A missing column, a row without a level, or a curve with other levels than the first.
    pub fn read(table: &SweepTable, im: &str) -> Result<Ida, SweepTableError> {
        let (measures, peaks) = (table.numbers(im)?, table.numbers("peak.theta/alpha")?);
        let ends = table.ends()?;
        let keys = table.fields_before("scale")?;
        let mut found: BTreeMap<String, Vec<(f64, Response)>> = BTreeMap::new();
        for (row, ((level, peak), end)) in measures.into_iter().zip(peaks).zip(ends).enumerate() {
            let Some(level) = level else { return Err(table.no_level(row, im)) };
            let response = match (end, peak) {
                (End::Completed, Some(peak)) => Response::Stands(peak),
                (End::Overturned, _) => Response::Overturns,
                (End::Completed | End::Separated | End::Undecided | End::Failed, _) => Response::Unknown,
            };
            found.entry(keys[row].clone()).or_default().push((level, response));
        }
        let mut curves: Vec<Vec<(f64, Response)>> = found.into_values().collect();
        curves.iter_mut().for_each(|curve| curve.sort_by(|a, b| a.0.total_cmp(&b.0)));
        let levels: Vec<f64> = curves.first().into_iter().flatten().map(|(level, _)| *level).collect();
        // A scaled record meets its level to round-off.
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
        let fits = |curve: &Vec<(f64, Response)>| {
            curve.len() == levels.len() && curve.iter().zip(&levels).all(|((level, _), other)| same(*level, *other))
        };
        if !curves.iter().all(fits) {
            return Err(table.no_levels(im));
        }
        let responses = |curve: Vec<(f64, Response)>| curve.into_iter().map(|(_, response)| response).collect();
        Ok(Ida { levels, curves: curves.into_iter().map(responses).collect() })
    }

    /// The fractile of the known responses at each level: the least one that this fraction does not exceed.
    pub fn fractile(&self, fraction: f64) -> Vec<Response> {
        let at = |level: usize| {
            let order = |response: &Response| match *response {
                Response::Stands(peak) => peak,
                Response::Overturns | Response::Unknown => f64::INFINITY,
            };
            let known = self.curves.iter().map(|curve| curve[level]).filter(|response| *response != Response::Unknown);
            let mut known: Vec<Response> = known.collect();
            known.sort_by(|a, b| order(a).total_cmp(&order(b)));
            let rank = (fraction * known.len() as f64).ceil() as usize;
            known.get(rank.saturating_sub(1)).copied().unwrap_or(Response::Unknown)
        };
        (0..self.levels.len()).map(at).collect()
    }
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
        let message = read(&rows.replace("6,1,completed", "6,1.1,completed")).unwrap_err().to_string();
        assert!(message.starts_with("t.csv: the curves have different levels of PGV; expected"), "{message}");
        let message = read(&rows.replace("3,0.5,completed", "3,,completed")).unwrap_err().to_string();
        assert!(message.contains("row 2 has PGV [m/s] = "), "{message}");
    }
}
