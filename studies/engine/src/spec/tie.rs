//! Text of an option → a tie or a damper.

use rocking_block::block::restraints::{LinkKind, Tie};

/// Reads a tie, as in `block_z=2,ground_x=3,stiffness=1e5`; other values are zero.
///
/// # Errors
/// An unknown key, a value that is no number, or a tie that [`check`] refuses.
pub fn tie(text: &str) -> Result<Tie, String> {
    link(LinkKind::Tie, text)
}

/// Reads a damper, as in `block_x=1,ground_x=1,ground_z=-1,stiffness=1e6,yield_force=2e4`; other values are zero.
///
/// # Errors
/// An unknown key, a value that is no number, or a damper that [`check`] refuses.
pub fn damper(text: &str) -> Result<Tie, String> {
    link(LinkKind::Damper, text)
}

fn link(kind: LinkKind, text: &str) -> Result<Tie, String> {
    let keys = || kind.numbers().map(|number| number.name).collect::<Vec<_>>().join(", ");
    let (mut tie, mut found) = (Tie { kind, ..Tie::default() }, Vec::new());
    for part in text.split(',') {
        let Some((key, value)) = part.split_once('=') else {
            return Err(format!("found `{part}`; expected KEY=NUMBER, with a key of {}", keys()));
        };
        let (key, value) = (key.trim().to_ascii_lowercase(), value.trim());
        let field = tie.number(&key).ok_or_else(|| format!("found key `{key}`; expected one of {}", keys()))?;
        let number = value.parse().ok().filter(|number: &f64| number.is_finite());
        *field = number.ok_or_else(|| format!("found {key} = `{value}`; expected a finite number"))?;
        if found.contains(&key) {
            return Err(format!("found {key} twice; expected it once"));
        }
        found.push(key);
    }
    if !tie.is_present() {
        return Err(match kind {
            LinkKind::Tie => "expected a stiffness > 0, as in stiffness=1e5".into(),
            LinkKind::Damper => {
                "expected a stiffness > 0, as in stiffness=1e6, or a damping > 0, as in damping=1e4".into()
            }
        });
    }
    check(&tie)?;
    Ok(tie)
}

/// Refuses an impossible tie or damper, and a hardening that has no effect.
///
/// # Errors
/// The first impossible parameter.
pub fn check(tie: &Tie) -> Result<(), String> {
    tie.check(&format!("a {}", tie.kind.word())).map_err(|error| error.to_string())?;
    if tie.yield_force > 0.0 && !tie.yields() {
        return Err(format!("found yield_force = {} without stiffness; expected both", tie.yield_force));
    }
    if tie.hardening > 0.0 && !tie.yields() {
        return Err(format!("found hardening = {} without yield_force; expected both", tie.hardening));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_stand_in_any_order() {
        let found = tie("stiffness=1e5, ground_x=-3,block_z=2.5,strength=4e3").unwrap();
        let expected = Tie {
            block: [0.0, 2.5],
            ground: [-3.0, 0.0],
            stiffness: 1e5,
            pretension: 0.0,
            slack: 0.0,
            damping: 0.0,
            strength: 4e3,
            yield_force: 0.0,
            hardening: 0.0,
            kind: LinkKind::Tie,
        };
        assert_eq!(found, expected);
        let found = damper("stiffness=1e5,ground_z=-1,yield_force=2e3,hardening=0.05").unwrap();
        let damper = Tie { ground: [0.0, -1.0], kind: LinkKind::Damper, ..Tie::default() };
        assert_eq!(found, Tie { stiffness: 1e5, yield_force: 2e3, hardening: 0.05, ..damper });
        assert_eq!(super::damper("ground_z=-1,damping=1e4").unwrap(), Tie { damping: 1e4, ..damper });
    }

    #[test]
    fn errors_say_what_was_found_and_expected() {
        for (text, words) in [
            ("block_z=2", &["stiffness > 0"][..]),
            ("stiffness=0,block_z=2", &["stiffness > 0"]),
            ("stifness=1,block_z=2", &["`stifness`", "stiffness"]),
            ("stiffness=1e5,block_z", &["`block_z`", "KEY=NUMBER"]),
            ("stiffness=1e5,block_z=two", &["block_z", "`two`", "finite number"]),
            ("stiffness=1e5,block_z=2,block_z=3", &["block_z twice"]),
            ("stiffness=1e5,block_z=2,slack=-1", &["slack", "-1", ">= 0"]),
            ("stiffness=1e5", &["distance of the ends of a tie = 0", "expected one above 0 m"]),
            ("stiffness=1e5,block_z=2,hardening=0.1", &["hardening = 0.1 without yield_force"]),
            ("stiffness=1e5,block_z=2,yield_force=1,hardening=1", &["hardening of a tie = 1", "below 1"]),
        ] {
            let error = tie(text).unwrap_err();
            assert!(words.iter().all(|word| error.contains(word)), "{text}: {error}");
        }
        for (text, words) in [
            ("ground_z=-1", "a stiffness > 0, as in stiffness=1e6, or a damping > 0"),
            ("ground_z=-1,damping=1e4,yield_force=1e3", "yield_force = 1000 without stiffness"),
            ("ground_z=-1,damping=1e4,stiffness=-1", "stiffness of a damper = -1"),
        ] {
            let error = damper(text).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
        let error = damper("stiffness=1e5,block_z=2,slack=0.1").unwrap_err();
        assert!(
            error.starts_with("found key `slack`; expected one of block_x, ") && !error.contains("pretension"),
            "{error}"
        );
    }
}
