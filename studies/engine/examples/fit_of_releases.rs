//! A fit of a block to its releases, whose instructions `scripts/dev/instructions --fits` counts:
//! `fit_of_releases (rigid | supports) (fit | runs) SEED`; `runs` are plain runs with a row at each measured time.

#![allow(dead_code, reason = "tests use the rest of the module")]

#[path = "../tests/studies/planted.rs"]
mod planted;

use rocking_studies::fit::{Problem, fit};
use rocking_studies::run::Run;

/// Returns the numbers of runs of a fit. Never inlined, since callgrind counts inside it.
#[inline(never)]
fn counted(problem: Option<&Problem>, runs: &[Run]) -> [u64; 2] {
    let Some(problem) = problem else {
        runs.iter().for_each(|run| drop(run.history(|_| ()).expect("the case runs")));
        return [runs.len() as u64, 0];
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().expect("a pool");
    fit(problem, &pool, &|_, _| ()).expect("the case is fitted").runs
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [case, mode, seed] = &arguments[..] else { panic!("expected a case, fit or runs, and a seed") };
    let planted = match case.as_str() {
        "rigid" => planted::rigid(),
        "supports" => planted::supports(),
        other => panic!("case \"{other}\"; expected rigid or supports"),
    };
    let problem = planted.problem(planted.measured(seed.parse().expect("a seed")));
    let [without, with] = counted((mode == "fit").then_some(&problem), &planted.runs());
    println!("{without} {with}");
}
