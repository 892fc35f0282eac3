//! Many instances in one process, in turn and concurrently: same bits, no leaks.

use crate::fmu::{self, Fmu, OK, reference};
use crate::sealed;
use rocking_block::fmi::fmi2::exports::fmi2DeSerializeFMUstate;

/// Communication step (s).
const STEP: f64 = 0.01;

/// Returns the number of instances: `usual`, or fewer for slow tools by ROCKING_BLOCK_INSTANCES.
fn instances(usual: usize) -> usize {
    match std::env::var("ROCKING_BLOCK_INSTANCES") {
        Ok(text) => text.parse::<usize>().expect("ROCKING_BLOCK_INSTANCES is a number").clamp(8, usual),
        Err(_) => usual,
    }
}

/// Returns the default block under a pulse that makes it rock.
fn rocking() -> Fmu {
    let mut fmu = Fmu::new();
    for (name, value) in
        [("pulse.shape", 2.0), ("pulse.amplitude", 4.0), ("dimensionless.p", 2.0), ("on_separation", 2.0)]
    {
        assert_eq!(fmu.set(reference(name), value), OK);
    }
    assert_eq!([fmu.setup(None, 0.0, Some(10.0)), fmu.enter(), fmu.exit()], [OK; 3]);
    fmu
}

/// Advances one step with changing inputs and returns the outputs.
fn step(fmu: &mut Fmu, i: usize) -> Vec<u64> {
    let time = i as f64 * STEP;
    assert_eq!(fmu.set_reals(&[reference("a_gx"), reference("F_x")], &[(7.0 * time).sin(), 100.0 * time]), OK);
    assert_eq!(fmu.set_rates(&[reference("a_gx")], &[1], &[7.0 * (7.0 * time).cos()]), OK);
    assert_eq!(fmu.step(time, (i + 1) as f64 * STEP - time), OK);
    fmu.bits()
}

fn run(steps: usize) -> Vec<Vec<u64>> {
    let mut fmu = rocking();
    (0..steps).map(|i| step(&mut fmu, i)).collect()
}

#[test]
fn a_thousand_instances_in_turn_give_the_bits_of_one() {
    const STEPS: usize = 200;
    let alone = run(STEPS);
    let distinct: std::collections::HashSet<_> = alone.iter().collect();
    assert_eq!(distinct.len(), STEPS, "the run moves in every step");
    let mut many: Vec<Fmu> = (0..instances(1000)).map(|_| rocking()).collect();
    for (i, expected) in alone.iter().enumerate() {
        for (j, fmu) in many.iter_mut().enumerate() {
            assert_eq!(&step(fmu, i), expected, "instance {j} in step {i}");
        }
    }
}

#[test]
fn eight_threads_at_once_give_the_bits_of_one() {
    const STEPS: usize = 500;
    let alone = run(STEPS);
    std::thread::scope(|scope| {
        for thread in [(); 8].map(|()| scope.spawn(|| run(STEPS))) {
            assert_eq!(thread.join().unwrap(), alone);
        }
    });
}

/// States of phases that FMI 2.0 Co-Simulation lacks are refused: an instance could not leave them, nor be freed.
///
/// Saved states of FMI 3.0 and Model Exchange have the same format otherwise.
#[test]
fn states_of_foreign_phases_are_refused() {
    for (phase, refused) in [(0, false), (1, true), (2, false)] {
        let mut fmu = rocking();
        let before = fmu.bits();
        let mut other = Fmu::new();
        assert_eq!(other.save(0), OK);
        // Interface and phase are the first two bytes of the content.
        let mut content = sealed::content(&other.serialize(0).unwrap()).to_vec();
        assert_eq!(content[..2], [0, 0]);
        content[1] = phase;
        assert_eq!(fmu.deserialize(&sealed::seal(&content)), if refused { fmu::ERROR } else { OK }, "phase {phase}");
        if refused {
            assert_eq!(fmu.bits(), before);
        } else {
            assert_eq!(fmu.restore(0), OK, "phase {phase}");
        }
        assert_eq!(fmu.free(0), OK);
        assert_eq!(fmu.reset(), OK);
    }
}

/// Runs in a child process, because concurrent tests allocate memory as well.
#[cfg(target_os = "linux")]
#[test]
fn ten_thousand_instances_in_turn_leak_no_memory() {
    const CHILD: &str = "ROCKING_BLOCK_RESIDENT";
    if std::env::var_os(CHILD).is_none() {
        let name = "instances::ten_thousand_instances_in_turn_leak_no_memory";
        let program = std::env::current_exe().unwrap();
        let child = std::process::Command::new(program).args(["--exact", name]).env(CHILD, "1").output().unwrap();
        let message = String::from_utf8_lossy(&child.stdout) + String::from_utf8_lossy(&child.stderr);
        assert!(child.status.success() && message.contains("1 passed"), "the child process failed:\n{message}");
        return;
    }
    let life = || {
        let mut fmu = rocking();
        step(&mut fmu, 0);
        assert_eq!(fmu.save(0), OK);
        let bytes = fmu.serialize(0).unwrap();
        assert_eq!(fmu.deserialize(&bytes), OK);
        assert_eq!(fmu.restore(1), OK);
        assert_ne!(fmu.deserialize(&bytes[1..]), OK);
        // A missing output pointer once leaked the state.
        // SAFETY: the instance lives, and a null pointer is refused.
        let status =
            unsafe { fmi2DeSerializeFMUstate(fmu.component, bytes.as_ptr().cast(), bytes.len(), std::ptr::null_mut()) };
        assert_ne!(status, OK);
    };
    let lives = instances(10_000);
    (0..lives / 10).for_each(|_| life());
    let before = resident();
    (0..lives).for_each(|_| life());
    let grown = resident().saturating_sub(before);
    // A reduced number means a memory checker, which allocates itself and finds leaks anyway.
    assert!(lives < 10_000 || grown < 1 << 20, "{lives} instances left {grown} bytes");
}

/// Returns the resident memory of this process (bytes).
#[cfg(target_os = "linux")]
fn resident() -> usize {
    // SAFETY: a query without pointers.
    let page = unsafe { libc::sysconf(libc::_SC_PAGESIZE) } as usize;
    let text = std::fs::read_to_string("/proc/self/statm").unwrap();
    text.split_whitespace().nth(1).and_then(|pages| pages.parse::<usize>().ok()).unwrap() * page
}
