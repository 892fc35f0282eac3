//! Text of an option → a tie.

use rocking_block::block::restraints::Tie;
use rocking_block::block::restraints::tie::NUMBERS;

/// Reads a tie, as in `block_z=2,ground_x=3,stiffness=1e5`; other values are zero.
pub fn tie(text: &str) -> Result<Tie, String> {
    let keys = || NUMBERS.map(|(key, _)| key).join(", ");
    let (mut tie, mut found) = (Tie::default(), Vec::new());
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
    if tie.stiffness <= 0.0 {
        return Err("expected a stiffness > 0, as in stiffness=1e5".into());
    }
    tie.check().map_err(|error| error.to_string())?;
    Ok(tie)
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
        };
        assert_eq!(found, expected);
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
            ("stiffness=1e5", &["length of a tie = 0", "a distance of its ends above 0"]),
        ] {
            let error = tie(text).unwrap_err();
            assert!(words.iter().all(|word| error.contains(word)), "{text}: {error}");
        }
    }
}
