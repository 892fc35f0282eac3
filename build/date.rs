//! SOURCE_DATE_EPOCH or the sources' last commit → `generationDateAndTime`.

use std::process::Command;

use crate::SOURCES;

/// Date of sources outside any repository (s since 1970). It is 1980, the earliest date that a ZIP archive can hold.
const UNKNOWN: i64 = 315_532_800;

/// Returns the date of generation: SOURCE_DATE_EPOCH, the author's date of the sources' last commit, or a fixed date.
///
/// The same commit therefore gives the same bytes in a clone that has its history; in a shallow one git reports the oldest commit it has.
pub fn generation() -> Result<String, String> {
    println!("cargo::rerun-if-env-changed=SOURCE_DATE_EPOCH");
    let seconds = match std::env::var("SOURCE_DATE_EPOCH") {
        Ok(text) => text.parse().map_err(|_| format!("SOURCE_DATE_EPOCH = {text}; expected seconds since 1970"))?,
        Err(_) => last_commit().unwrap_or(UNKNOWN),
    };
    Ok(utc(seconds))
}

fn last_commit() -> Option<i64> {
    // The author's date outlives a rebase.
    let log = Command::new("git").args(["log", "-1", "--format=%at", "--"]).args(SOURCES).output().ok()?;
    String::from_utf8(log.stdout).ok()?.trim().parse().ok()
}

/// Seconds since 1970 → a date of ISO 8601; H. Hinnant's `civil_from_days`, whose years begin in March.
pub fn utc(seconds: i64) -> String {
    let (days, second) = (seconds.div_euclid(86_400) + 719_468, seconds.rem_euclid(86_400));
    let (era, day) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let since_march = (5 * day + 2) / 153;
    let (month, day) = ((since_march + 2) % 12 + 1, day - (153 * since_march + 2) / 5 + 1);
    let year = year + era * 400 + i64::from(month <= 2);
    let (hour, minute, second) = (second / 3_600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}
