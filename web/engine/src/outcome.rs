//! A history → its outcome in words.

use rocking_block::block::Foundation;
use rocking_block::block::restraints::{self, tie};
use rocking_block::simulation::Ending;
use rocking_block::system::events::EventKind;
use rocking_charts::numerals::significant;
use rocking_studies::run::outcome::End;
use rocking_studies::run::{History, Run};

/// Describes the outcome in a sentence for laymen.
pub fn sentence(run: &Run, history: &History) -> String {
    let History { peaks, counts, end, ending, .. } = history;
    let last = history.rows.last();
    let end_time = ending.map_or(last.map_or(0.0, |row| row.time), |(_, time)| time);
    let time = significant(end_time, 3);
    let part = significant(100.0 * peaks.theta / run.block.alpha, 3);
    let side = if last.is_some_and(|row| row.observation.theta < 0.0) { "left" } else { "right" };
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
        End::Completed => format!("The block rocks to {part} % of the critical tilt α and stays upright."),
        End::Undecided => {
            format!("Still undecided after {time} s: the run is too short to tell whether the block overturns.")
        }
        End::Failed => "The integration failed.".into(),
    };
    // Without a limit of friction the foot slips only where no force presses it down.
    let slip = (run.block.friction > 0.0).then(|| slip(peaks.slip)).flatten();
    [outcome].into_iter().chain(slip).chain(broken_ties(history)).collect::<Vec<_>>().join(" ")
}

fn slip(slip: f64) -> Option<String> {
    (slip > 0.0).then(|| format!("Its foot slips by up to {} mm.", significant(1e3 * slip, 3)))
}

fn broken_ties(history: &History) -> Option<String> {
    let breaks: Vec<f64> = history
        .events
        .iter()
        .filter(|event| matches!(event.kind, EventKind::Restraint(restraints::Event::Tie(_, tie::Event::Break))))
        .map(|event| event.time)
        .collect();
    match breaks.as_slice() {
        [] => None,
        [time] => Some(format!("A tie breaks at {} s.", significant(*time, 3))),
        [first, ..] => Some(format!("{} ties break, the first at {} s.", breaks.len(), significant(*first, 3))),
    }
}
