#![allow(clippy::unwrap_used)]
use super::super::average_range::average_and_range;
use super::*;

/// Worked example of AIAG's Measurement Systems Analysis: 3 appraisers, 3 trials, 10 parts.
const AIAG: [[[f64; 10]; 3]; 3] = [
    [
        [
            0.29, -0.56, 1.34, 0.47, -0.80, 0.02, 0.59, -0.31, 2.26, -1.36,
        ],
        [
            0.41, -0.68, 1.17, 0.50, -0.92, -0.11, 0.75, -0.20, 1.99, -1.25,
        ],
        [
            0.64, -0.58, 1.27, 0.64, -0.84, -0.21, 0.66, -0.17, 2.01, -1.31,
        ],
    ],
    [
        [
            0.08, -0.47, 1.19, 0.01, -0.56, -0.20, 0.47, -0.63, 1.80, -1.68,
        ],
        [
            0.25, -1.22, 0.94, 1.03, -1.20, 0.22, 0.55, 0.08, 2.12, -1.62,
        ],
        [
            0.07, -0.68, 1.34, 0.20, -1.28, 0.06, 0.83, -0.34, 2.19, -1.50,
        ],
    ],
    [
        [
            0.04, -1.38, 0.88, 0.14, -1.46, -0.29, 0.02, -0.46, 1.77, -1.49,
        ],
        [
            -0.11, -1.13, 1.09, 0.20, -1.07, -0.67, 0.01, -0.56, 1.45, -1.77,
        ],
        [
            -0.15, -0.96, 0.67, 0.11, -1.45, -0.49, 0.21, -0.49, 1.87, -2.16,
        ],
    ],
];

fn study() -> Vec<Reading> {
    let mut readings = Vec::new();
    for (operator, trials) in AIAG.iter().enumerate() {
        for (trial, parts) in trials.iter().enumerate() {
            for (part, &value) in parts.iter().enumerate() {
                let (part, operator) = (part.to_string(), operator.to_string());
                readings.push(Reading {
                    part,
                    operator,
                    trial: trial.to_string(),
                    value,
                });
            }
        }
    }
    readings
}

#[test]
fn aiags_worked_example_gives_its_published_sums_of_squares() {
    let cells = crossing::cells(&study()).unwrap();
    let squares = Squares::of(&cells, &Sizes::of(&cells));
    let published = [88.3619, 3.1673, 0.3590, 2.7589];
    let found = [
        squares.parts,
        squares.operators,
        squares.interaction,
        squares.repeats,
    ];
    for (found, published) in found.iter().zip(published) {
        assert!(
            (found - published).abs() < 5.1e-5,
            "{found} for {published}"
        );
    }
}

#[test]
fn aiags_worked_example_gives_its_published_components() {
    let it = anova(&study()).unwrap();
    let found = [
        it.repeatability,
        it.reproducibility,
        it.grr,
        it.part,
        it.total,
    ];
    let published = [0.199933, 0.226838, 0.302373, 1.042327, 1.085300];
    for (found, published) in found.iter().zip(published) {
        assert!((found - published).abs() < 2e-5, "{found} for {published}");
    }
    assert_eq!((it.interaction, it.ndc), (0.0, Some(4)));
    assert!((it.pct_grr.unwrap() - 27.86).abs() < 0.01);
    assert!((it.interaction_p.unwrap() - 0.974).abs() < 1e-3);
}

#[test]
fn aiags_worked_example_gives_its_published_averages_and_ranges() {
    let it = average_and_range(&study()).unwrap();
    let found = [
        it.repeatability,
        it.reproducibility,
        it.grr,
        it.part,
        it.total,
    ];
    let published = [0.20188, 0.22963, 0.30575, 1.10456, 1.14610];
    for (found, published) in found.iter().zip(published) {
        assert!((found - published).abs() < 2e-4, "{found} for {published}");
    }
    let percent = |sd: f64| 100.0 * sd / it.total;
    assert!((percent(it.repeatability) - 17.62).abs() < 0.02);
    assert!((percent(it.reproducibility) - 20.04).abs() < 0.02);
    assert!((it.pct_grr.unwrap() - 26.68).abs() < 0.02);
    assert!((percent(it.part) - 96.38).abs() < 0.02);
    assert_eq!((it.interaction, it.ndc), (0.0, Some(5)));
}

#[test]
fn averages_and_ranges_refuse_studies_beyond_their_factors() {
    let more: Vec<Reading> = study()
        .into_iter()
        .map(|it| Reading {
            trial: format!("{} again", it.trial),
            ..it
        })
        .chain(study())
        .collect();
    let refusal = average_and_range(&more).unwrap_err();
    assert!(matches!(refusal, GaugeRrError::NoFactors { trials: 6, .. }));
    assert!(anova(&more).is_ok());
}

#[test]
fn five_percent_points_of_the_tables_come_back() {
    for (f, above, below) in [
        (161.448, 1.0, 1.0),
        (4.9646, 1.0, 10.0),
        (2.7109, 5.0, 20.0),
        (1.7784, 18.0, 60.0),
    ] {
        let p = upper_tail(f, above, below);
        assert!((p - 0.05).abs() < 2e-5, "F({above}, {below}) = {f}: {p}");
    }
    assert_eq!(upper_tail(f64::INFINITY, 18.0, 60.0), 0.0);
}

#[test]
fn an_offset_of_the_scale_changes_nothing() {
    let shifted: Vec<Reading> = study()
        .into_iter()
        .map(|it| Reading {
            value: it.value + 1e6,
            ..it
        })
        .collect();
    let (near, far) = (anova(&study()).unwrap(), anova(&shifted).unwrap());
    assert!((near.grr - far.grr).abs() < 1e-8 && (near.part - far.part).abs() < 1e-8);
}

#[test]
fn an_incomplete_study_names_what_is_missing() {
    let mut readings = study();
    let lost = readings.pop().unwrap();
    assert_eq!(
        anova(&readings).unwrap_err(),
        GaugeRrError::Missing {
            part: lost.part,
            operator: lost.operator,
            trial: lost.trial
        }
    );
    let mut twice = study();
    twice.push(twice[0].clone());
    assert!(matches!(anova(&twice), Err(GaugeRrError::Twice { .. })));
    assert!(matches!(anova(&[]), Err(GaugeRrError::TooSmall { .. })));
}

#[test]
fn a_reading_whose_square_overflows_is_refused() {
    for value in [1e200, -1e150, f64::NAN, f64::INFINITY] {
        let mut readings = study();
        readings[0].value = value;
        assert!(
            matches!(anova(&readings), Err(GaugeRrError::TooLarge { .. })),
            "{value}"
        );
    }
}

#[test]
fn one_operator_leaves_repeatability_and_parts() {
    let one: Vec<Reading> = study()
        .into_iter()
        .filter(|it| it.operator == "0")
        .collect();
    let it = anova(&one).unwrap();
    assert_eq!(
        (it.reproducibility, it.interaction, it.interaction_p),
        (0.0, 0.0, None)
    );
    assert!(it.repeatability > 0.0 && it.part > it.repeatability);
}

#[test]
fn a_gauge_without_variation_has_no_number_of_categories() {
    let flat: Vec<Reading> = study()
        .into_iter()
        .map(|it| Reading { value: 1.0, ..it })
        .collect();
    let it = anova(&flat).unwrap();
    assert_eq!((it.ndc, it.pct_grr, it.total), (None, None, 0.0));
}
