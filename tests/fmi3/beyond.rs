//! Early return at slip, grip, taut and slack ties, and breaks, at the times of independent trajectories.

use std::collections::BTreeSet;

use rocking_block::block::restraints::tie;

use crate::beyond_cases::{Case, Change, cases, cases_with_links};
use crate::functions::OK;
use crate::host::{Instance, Wanted, call};

/// Differences of event times from the trajectory (s).
const CLOSE: f64 = 1e-7;

/// The time after an event (s) at which a foot that slides has a direction, and a taut tie a tension.
const MOMENT: f64 = 1e-8;

/// The discrete outputs: regime, direction of slip, and for each tie whether it pulls and whether it has broken.
#[derive(Clone, Copy, Debug, PartialEq)]
struct State {
    regime: i32,
    slip: i32,
    pulls: [bool; 2],
    broken: [bool; 2],
}

impl State {
    fn of(instance: &Instance) -> State {
        let slides = instance.get("slides") == 1.0;
        State {
            regime: instance.get("regime") as i32,
            slip: if slides { instance.get("slip_rate").signum() as i32 } else { 0 },
            pulls: ["tie_1.tension", "tie_2.tension"].map(|name| instance.get(name) > 0.0),
            broken: ["tie_1.broken", "tie_2.broken"].map(|name| instance.get(name) == 1.0),
        }
    }
}

/// Stops a case at its events, with or without Event Mode, and returns the kinds of changes.
fn run(case: &Case, event_mode: bool) -> BTreeSet<&'static str> {
    let instance = Instance::new(Wanted { event_mode, early_return: true, ..Wanted::default() });
    case.parameters().iter().for_each(|(name, value)| instance.set(name, *value));
    instance.ok(call!(instance, enter_initialization_mode, true, 1e-10, 0.0, false, 0.0));
    instance.ok(call!(instance, exit_initialization_mode));
    if event_mode {
        instance.handle_event();
    }
    let (name, mut now, mut kinds) = (&case.name, 0.0, BTreeSet::new());
    let mut state = State::of(&instance);
    for (time, change) in case.lasting_events() {
        // A step that would end some time after the event.
        let stepped = instance.step(now, time - now + 0.003);
        now = stepped.reached;
        let at = format!("{name}: {stepped:?}, not {change:?} at {time} s");
        assert!(stepped.early && stepped.event == event_mode && (now - time).abs() < CLOSE, "{at}");
        if event_mode {
            assert_eq!(call!(instance, enter_event_mode), OK);
            instance.handle_event();
        }
        let moment = instance.step(now, MOMENT);
        assert!(!moment.early, "{at}: {moment:?}");
        now = moment.reached;
        let before = std::mem::replace(&mut state, State::of(&instance));
        match change {
            Change::Regime { regime, slip } => {
                assert_eq!((state.regime, state.slip), (regime, slip), "{at}");
                match (before.slip, slip) {
                    (0, 0) => {}
                    (_, 0) => _ = kinds.insert("grip"),
                    (before, now) if before != now => _ = kinds.insert("slip"),
                    _ => {}
                }
            }
            Change::Tie(tie) => {
                let place: usize = tie[tie.len() - 1..].parse().unwrap();
                let breaks = tie.starts_with("break");
                assert_eq!((before.broken[place], state.broken[place]), (false, breaks), "{at}");
                assert!(!breaks || (before.pulls[place] && !state.pulls[place]), "{at}: {before:?}, {state:?}");
                assert!(breaks || before.pulls[place] != state.pulls[place], "{at}: {before:?}, {state:?}");
                kinds.insert(if breaks {
                    "break"
                } else if state.pulls[place] {
                    "taut"
                } else {
                    "slack"
                });
            }
        }
    }
    kinds
}

/// Each event of the pulse cases ends a step early, at its time, and changes the motion as in the trajectory.
#[test]
fn steps_return_early_at_slip_grip_taut_slack_and_break() {
    for event_mode in [true, false] {
        let cases = cases().into_iter().filter(|case| case.a_gx.record.is_none());
        let kinds: BTreeSet<&str> = cases.flat_map(|case| run(&case, event_mode)).collect();
        assert_eq!(Vec::from_iter(kinds), ["break", "grip", "slack", "slip", "taut"], "event mode {event_mode}");
    }
}

/// Each yielding, unloading and breaking of the pulse cases ends a step early at its time, and the plastic elongations then are those of the
/// trajectory's link: they change while it yields only.
#[test]
fn steps_return_early_where_ties_and_dampers_yield_and_unload() {
    for case in cases_with_links() {
        // A record would need its inputs; pauses of microseconds are events of their own.
        if case.a_gx.record.is_some() || case.name == "hybrid_friction" {
            continue;
        }
        let instance = Instance::new(Wanted { event_mode: true, early_return: true, ..Wanted::default() });
        case.parameters().iter().for_each(|(name, value)| instance.set(name, *value));
        instance.ok(call!(instance, enter_initialization_mode, true, 1e-10, 0.0, false, 0.0));
        instance.ok(call!(instance, exit_initialization_mode));
        instance.handle_event();
        let links = tie::names(case.block().ties());
        let plastic = || links.iter().map(|link| instance.get(&format!("{link}.plastic"))).collect::<Vec<f64>>();
        let mut yields = vec![false; links.len()];
        let mut now = 0.0;
        let mut loose = None;
        for (time, change) in case.lasting_events() {
            // Where the spring of a limp tie is loose, it stops yielding. That is no event: the tie stopped pulling when it became limp.
            if let Change::Tie(link) = &change
                && link.starts_with("slack")
            {
                loose = Some(link[link.len() - 1..].parse::<usize>().unwrap());
                continue;
            }
            let before = plastic();
            let stepped = instance.step(now, time - now + 0.003);
            now = stepped.reached;
            let at = format!("{}: {stepped:?}, not {change:?} at {time} s", case.name);
            assert!(stepped.early && stepped.event && (now - time).abs() < CLOSE, "{at}");
            for ((yields, before), after) in yields.iter().zip(before).zip(plastic()) {
                assert_eq!(*yields, before != after, "{at}: {before}, then {after}");
            }
            assert_eq!(call!(instance, enter_event_mode), OK);
            instance.handle_event();
            if let Some(place) = loose.take() {
                yields[place] = false;
            }
            if let Change::Tie(link) = &change {
                let place: usize = link[link.len() - 1..].parse().unwrap();
                // A limp tie yields on; without a dashpot it is slack at once.
                let keeps = link.starts_with("tie") && case.block().ties()[place].damping > 0.0;
                yields[place] = link.starts_with("yield") || (keeps && yields[place]);
            }
        }
    }
}

/// After a jump of the inputs `slides`, `regime` and `H` all show the motion after it.
#[test]
fn a_jump_of_the_inputs_shows_the_motion_after_it() {
    let (g, friction) = (9.81, 0.3);
    for (alpha, a_gx, slides, regime) in
        [(0.9, 5.0, 1.0, 0.0), (0.9, 2.9, 0.0, 0.0), (0.25, 2.6, 0.0, -1.0), (0.25, 8.0, 1.0, -1.0)]
    {
        let block = Instance::new(Wanted::default());
        block.set_all(&[("foundation", 2.0), ("friction", friction), ("dimensionless.alpha", alpha), ("g", g)]);
        block.initialize(false);
        block.step(0.0, 0.1);
        assert_eq!((block.get("slides"), block.get("regime")), (0.0, 0.0));
        block.set("a_gx", a_gx);
        assert_eq!((block.get("slides"), block.get("regime")), (slides, regime), "a_gx = {a_gx} m/s2");
        let limit = friction * (block.get("N_L") + block.get("N_R"));
        let (h, rounding) = (block.get("H").abs(), 1e-12 * limit);
        assert_eq!(slides == 1.0, (h - limit).abs() < rounding, "H = {h} N, limit {limit} N");
        let stepped = block.step(0.1, 1e-6);
        assert_eq!((block.get("slides"), block.get("regime")), (slides, regime), "{stepped:?}");
    }
}
