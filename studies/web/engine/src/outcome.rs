//! A history → its outcome in words.

use rocking_block::block::Foundation;
use rocking_block::simulation::Ending;
use rocking_charts::numerals::significant;
use rocking_studies::run::outcome::{Count, End, Holds};
use rocking_studies::run::{History, Run};

/// Describes the outcome in a sentence for laymen.
pub fn sentence(run: &Run, history: &History) -> String {
    let History { peaks, counts, end, ending, .. } = history;
    let last = history.rows.last();
    let end_time = ending.map_or(last.map_or(0.0, |row| row.time), |(_, time)| time);
    let time = significant(end_time, 3);
    let part = significant(100.0 * peaks.theta / run.block.alpha, 3);
    let side = if last.is_some_and(|row| row.observation.theta < 0.0) { "left" } else { "right" };
    let passed = history.lean.passed_balance();
    let outcome = match end {
        End::Overturned if matches!(ending, Some((Ending::Toppled, _))) => {
            format!("The block overturns to the {side}: it leaves its supports at {time} s, on its way over.")
        }
        End::Overturned => format!("The block overturns to the {side} and lies on its side at {time} s."),
        End::Separated => {
            format!("The block leaves the ground at {time} s, where the run ends. Let it fly to see whether it lands.")
        }
        End::Completed if counts.liftoffs == 0 => {
            let reason = match run.block.foundation {
                Foundation::Rigid if peaks.slip > 0.0 => "It slides before it can rock.".into(),
                Foundation::Rigid => "The motion is too weak to rock it.".to_string(),
                Foundation::Viscoelastic => format!("It sways by at most {part} % of the critical tilt α."),
            };
            format!("The block stays on both corners. {reason}")
        }
        End::Completed if history.ends_tilted(&run.block) => {
            let tilt = significant(100.0 * history.lean.end.abs() / run.block.alpha, 3);
            let by = kinds(run).map_or(String::new(), |[one, _]| format!(", held by a {one}"));
            let passed = if passed { "passes its balance and " } else { "" };
            format!("The block {passed}ends tilted to the {side}, at {tilt} % of the critical tilt α{by}.")
        }
        End::Completed if passed => {
            let end = if history.is_at_rest { "comes back upright" } else { "does not overturn" };
            format!("The block passes its balance, tilts to {part} % of the critical tilt α and {end}.")
        }
        End::Completed => format!("The block rocks to {part} % of the critical tilt α and stays upright."),
        End::Undecided => {
            format!("Still undecided after {time} s: the run is too short to tell whether the block overturns.")
        }
        End::Failed => "The integration failed.".into(),
    };
    // Without a limit of friction the foot slips only where no force presses it down.
    let slip = (run.block.friction > 0.0).then(|| slip(peaks.slip)).flatten();
    let is_open = matches!(end, End::Undecided | End::Separated);
    let passed = (is_open && passed).then(|| "It passed its balance.".to_string());
    [outcome].into_iter().chain(passed).chain(slip).chain(breaks(run, history)).collect::<Vec<_>>().join(" ")
}

fn slip(slip: f64) -> Option<String> {
    (slip > 0.0).then(|| format!("Its foot slips by up to {} mm.", significant(1e3 * slip, 3)))
}

/// The words for one and for several of a block's ties and dampers, if any.
fn kinds(run: &Run) -> Option<[&'static str; 2]> {
    match Holds::of(&run.block) {
        Holds { ties: 0, dampers: 0, .. } => None,
        Holds { dampers: 0, .. } => Some(["tie", "ties"]),
        Holds { ties: 0, .. } => Some(["damper", "dampers"]),
        Holds { .. } => Some(["tie or damper", "ties and dampers"]),
    }
}

fn breaks(run: &Run, history: &History) -> Option<String> {
    let Count { count, first } = history.breaks();
    let (first, [one, several]) = (significant(first?, 3), kinds(run)?);
    Some(match count {
        1 => format!("A {one} breaks at {first} s."),
        _ => format!("{count} {several} break, the first at {first} s."),
    })
}
