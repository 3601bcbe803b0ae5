//! Tests of the levels of detail of the motion, against all five states throughout.

use crate::world::relay::lumped::{
    Drive, Element, Event, Excitation, Model, Parameters, State, Waveform,
};
use crate::world::relay::motion::Motion;

/// Duration of a transient, s.
const END_S: f64 = 0.03;
/// Voltage of a step at which the armature only just leaves the unstable equilibrium, V.
const DYNAMIC_V: f64 = 7.855_922_331_955_684;

/// Returns the first opening and the first closing of both contacts, s; NaN for one that does not happen.
fn first_changes(events: &[Event]) -> [f64; 4] {
    let first = |element: Element, on: bool| {
        let mut changes = events.iter().filter(|it| it.element == element);
        changes.find(|it| it.on == on).map_or(f64::NAN, |it| it.t_s)
    };
    [
        first(Element::Nc, false),
        first(Element::Nc, true),
        first(Element::No, false),
        first(Element::No, true),
    ]
}

/// Returns the first closing of the normally open contact from rest, s; NaN when it stays open.
fn made(model: &Model, drive: Drive) -> f64 {
    let mut motion = Motion::from_equilibrium(model.clone(), 0.0, drive, model.at_rest(0.0));
    let events = std::iter::from_fn(|| motion.advance(0.06));
    let [.., make_s] = first_changes(&events.collect::<Vec<_>>());
    make_s
}

/// Returns the largest distance of a first change from that of all five states, s.
#[track_caller]
fn distance(model: &Model, start: State, drive: Drive) -> f64 {
    let mut motion = Motion::from_equilibrium(model.clone(), 0.0, drive, start);
    let own: Vec<Event> = std::iter::from_fn(|| motion.advance(END_S)).collect();
    let excitation = match drive {
        Drive::Source { volts, .. } => {
            Excitation::Source(Waveform::new(vec![[0.0, volts]]).unwrap())
        }
        Drive::Suppression { volts } => Excitation::Suppression(volts),
    };
    let whole = model.transient(start, &excitation, END_S, 1e-10).unwrap();
    let (own, whole) = (first_changes(&own), first_changes(&whole.events));
    let pairs = || own.iter().zip(&whole);
    assert!(
        pairs().all(|(one, other)| one.is_nan() == other.is_nan()),
        "{own:?}, expected {whole:?}"
    );
    let apart = pairs().map(|(one, other)| (one - other).abs());
    apart.fold(0.0, f64::max)
}

#[test]
fn no_level_of_detail_moves_a_first_change() {
    let model = Model::new(&Parameters::default());
    let pickup = model.pickup().volts;
    for volts in [1.001 * pickup, 1.01 * pickup, 9.0, 12.0, 16.0] {
        let off_s = distance(&model, model.at_rest(0.0), Drive::still(volts));
        assert!(off_s < 1e-6, "{volts} V: {off_s:e} s");
    }
    for k_ec in [340.0, 1100.0, 2500.0, 6000.0] {
        let model = Model::new(&Parameters {
            k_ec,
            ..Parameters::default()
        });
        for volts in [60.0, 24.7, 0.7] {
            let off_s = distance(&model, model.sealed(12.0), Drive::Suppression { volts });
            assert!(off_s < 1e-6, "{k_ec} S, off into {volts} V: {off_s:e} s");
        }
    }
}

#[test]
fn a_step_near_the_dynamic_threshold_takes_the_reference_time() {
    let model = Model::new(&Parameters::default());
    for (above, expected_ms, within_ms) in [(1e-3, 29.540_083_83, 3e-3), (1e-6, 43.795_212_29, 0.2)]
    {
        let make_s = made(&model, Drive::still(DYNAMIC_V * (1.0 + above)));
        assert!(
            (1e3 * make_s - expected_ms).abs() < within_ms,
            "{above:e} above: {make_s} s"
        );
    }
}

#[test]
fn hops_left_out_hardly_move_the_next_operation() {
    for after_ms in [40.0, 45.0, 50.0, 60.0, 80.0] {
        let model = Model::new(&Parameters::default());
        let start = model.at_rest(0.0);
        let (off, again) = (0.02, 0.02 + 1e-3 * after_ms);
        let mut motion = Motion::from_equilibrium(model.clone(), 0.0, Drive::still(12.0), start);
        while motion.advance(off).is_some() {}
        motion.set(Drive::still(0.0), model.ohm());
        let moving_s = motion.levels().moving_s;
        while motion.advance(again).is_some() {}
        let moved_s = motion.levels().moving_s - moving_s;
        assert!(
            moved_s < 1e-3 * after_ms - 1e-3,
            "never held in {moved_s} s"
        );
        motion.set(Drive::still(12.0), model.ohm());
        let own: Vec<Event> = std::iter::from_fn(|| motion.advance(again + 0.006)).collect();
        let wave = vec![
            [0.0, 12.0],
            [off, 12.0],
            [off, 0.0],
            [again, 0.0],
            [again, 12.0],
        ];
        let excitation = Excitation::Source(Waveform::new(wave).unwrap());
        let whole = model
            .transient(start, &excitation, again + 0.006, 1e-10)
            .unwrap();
        let later = |it: &Event| it.t_s > again;
        let whole: Vec<Event> = whole.events.into_iter().filter(later).collect();
        let [.., own_s] = first_changes(&own);
        let [.., whole_s] = first_changes(&whole);
        let off_s = (own_s - whole_s).abs();
        assert!(off_s < 1e-6, "{after_ms} ms after the release: {off_s:e} s");
    }
}
