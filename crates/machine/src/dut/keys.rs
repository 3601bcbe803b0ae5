//! Keys of a recipe: the form of those that a kind of device adds, and those that several kinds have in common.

use crate::form::{Form, Key, Range, from_to, key};

/// Keys that one kind of device may have in four sections of its recipe.
#[derive(Debug, Clone, Copy)]
pub struct Sections {
    /// Keys of `[part]`.
    pub part: &'static [Key],
    /// Keys of `[limits]`: a table for each characteristic.
    pub limits: &'static [Key],
    /// Keys of `[external]`: a table for each result from outside of the rig that a recipe of this kind may demand.
    pub external: &'static [Key],
    /// Keys of `[test]`.
    pub test: &'static [Key],
}

const LENGTH: Range = Range {
    unit: "mm",
    low: 0.0,
    high: 200.0,
    low_allowed: false,
};

/// Key of `[part]`: size of the body.
pub const BODY: Key = key(
    "body_mm",
    Form::Numbers(3, LENGTH),
    "guard",
    "body along x, y, z as it lies in the nest",
);

/// Key of `[part]`: length of the pins.
pub const PIN_LENGTH: Key = key(
    "pin_length_mm",
    from_to(0.0, 50.0, "mm"),
    "guard",
    "length of the pins below the body",
);

/// Key of `[part]`: temperature to which results are converted.
pub const REFERENCE_TEMPERATURE: Key = key(
    "reference_temperature_c",
    from_to(-40.0, 85.0, "C"),
    "gauge",
    "temperature that results are converted to",
);

/// Form of a limit: a table with `low` and `high`, each from 0 to `$high` in `$unit`; a recipe may omit either.
macro_rules! limit {
    ($unit:literal, $high:literal) => {
        crate::form::Form::Table(&[
            crate::form::optional(
                "low",
                crate::form::from_to(0.0, $high, $unit),
                "gauge",
                "least good value",
            ),
            crate::form::optional(
                "high",
                crate::form::from_to(0.0, $high, $unit),
                "gauge",
                "greatest good value",
            ),
        ])
    };
}
pub(crate) use limit;

/// Form of a limit of a quantity that may be negative: as [`limit!`], each side from `-$high` to `$high`.
macro_rules! signed_limit {
    ($unit:literal, $high:literal) => {
        crate::form::Form::Table(&[
            crate::form::optional(
                "low",
                crate::form::from_to(-$high, $high, $unit),
                "gauge",
                "least good value",
            ),
            crate::form::optional(
                "high",
                crate::form::from_to(-$high, $high, $unit),
                "gauge",
                "greatest good value",
            ),
        ])
    };
}
pub(crate) use signed_limit;

/// Form of the limit of a result from outside of the rig: a table that must have `low`.
macro_rules! at_least {
    ($external:expr) => {
        crate::form::Form::Table(&[crate::form::key(
            "low",
            crate::form::Form::Number($external.range()),
            "history",
            "least good value",
        )])
    };
}
pub(crate) use at_least;

/// As [`at_least!`], with `high`.
macro_rules! at_most {
    ($external:expr) => {
        crate::form::Form::Table(&[crate::form::key(
            "high",
            crate::form::Form::Number($external.range()),
            "history",
            "greatest good value",
        )])
    };
}
pub(crate) use at_most;

/// Keys of one table, written one per line.
macro_rules! table {
    ($($key:expr;)+) => { &[$($key),+] };
}
pub(crate) use table;

#[cfg(test)]
mod tests {
    use crate::dut::{External, Kind};

    #[test]
    fn a_recipe_limits_every_characteristic_of_its_kind() {
        for kind in Kind::ALL {
            let limits = kind.sections().limits.iter().map(|key| key.name);
            assert!(limits.eq(kind.characteristics().iter().map(|it| it.key())));
        }
    }

    #[test]
    fn external_keys_of_recipes_are_those_of_results() {
        let names = |kind: Kind| kind.sections().external.iter().map(|key| key.name);
        for kind in Kind::ALL {
            assert!(names(kind).all(|name| External::from_key(name).is_some()));
        }
        assert!(names(Kind::Ssr).eq(External::ALL.map(External::key)));
    }

    #[test]
    fn every_kind_has_its_name_in_its_place() {
        for kind in Kind::ALL {
            assert_eq!(Kind::NAMES[kind as usize], kind.name());
        }
    }
}
