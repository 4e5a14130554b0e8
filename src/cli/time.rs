//! Seconds since 1970 to the form in which PLCopen XML has its times.

/// The time of creation where none is given.
pub const DEFAULT: &str = "1970-01-01T00:00:00";

/// The last second of the year 9999; XML Schema has no room for more digits without a change of form.
const LAST: u64 = 253_402_300_799;

/// `seconds` after 1970-01-01T00:00:00 UTC as `xs:dateTime`, up to the year 9999.
pub fn date_time(seconds: u64) -> Option<String> {
    if seconds > LAST {
        return None;
    }
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    let (year, month, day) = civil(days);
    let (h, m, s) = (second / 3600, second / 60 % 60, second % 60);
    Some(format!("{year:04}-{month:02}-{day:02}T{h:02}:{m:02}:{s:02}"))
}

/// The date in the Gregorian calendar, days counted from 1970-01-01. The year is taken to begin in
/// March, so that the leap day is its last (Howard Hinnant, "chrono-compatible low-level date
/// algorithms").
fn civil(days: u64) -> (u64, u64, u64) {
    let since_0000_03_01 = days + 719_468;
    let era = since_0000_03_01 / 146_097;
    let day_of_era = since_0000_03_01 % 146_097;
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    (year, month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_become_dates() {
        let date = |s| date_time(s).unwrap();
        assert_eq!(date(0), DEFAULT);
        assert_eq!(date(951_782_399), "2000-02-28T23:59:59");
        assert_eq!(date(951_782_400), "2000-02-29T00:00:00");
        assert_eq!(date(1_772_323_200), "2026-03-01T00:00:00");
        assert_eq!(date(4_107_542_400), "2100-03-01T00:00:00");
        assert_eq!(date(LAST), "9999-12-31T23:59:59");
        assert_eq!(date_time(LAST + 1), None);
    }
}
