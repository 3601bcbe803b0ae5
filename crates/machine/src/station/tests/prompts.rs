//! Prompts: nothing moves while one is open, and its answer decides how the lot goes on.

use super::machine::{Machine, Specimen};
use crate::dut::prompt::{Choice, Prompt, PromptMoment, check};
use crate::station::orders::{Order, Refused};
use crate::station::packml::Command;
use crate::station::turn::Ending;

fn prompt(name: &str, when: PromptMoment) -> Prompt {
    let choice = |name: &str, stops| Choice {
        name: name.into(),
        text_en: name.into(),
        text_zh: name.into(),
        stops,
    };
    Prompt {
        name: name.into(),
        when,
        text_en: name.into(),
        text_zh: name.into(),
        picture: None,
        choices: vec![choice("done", false), choice("stop", true)],
    }
}

/// Makes a lot of one part that asks at these moments.
fn lot(moments: &[PromptMoment]) -> Machine {
    let all = moments.iter().enumerate();
    let prompts = all.map(|(place, when)| prompt(&place.to_string(), *when));
    Machine::with_prompts(vec![Specimen::MissingPin], prompts.collect())
}

fn answer(machine: &mut Machine, prompt: &str, choice: &str) -> Result<(), Refused> {
    machine.order(Order::Answer(prompt.into(), choice.into()))
}

/// Turns until a prompt is open; returns its name.
fn opened(machine: &mut Machine) -> String {
    for _ in 0..6000 {
        if let Some(prompt) = machine.station.prompt() {
            return prompt.name.clone();
        }
        machine.turn();
    }
    panic!("no prompt opened in {:?}", machine.station.outer());
}

/// Checks that the machine rests while the prompt is open.
fn rests(machine: &mut Machine) {
    let before = machine.driven();
    for _ in 0..500 {
        machine.turn();
    }
    assert_eq!(machine.driven(), before, "a motion while a prompt is open");
    assert_eq!(machine.ending, None);
}

#[test]
fn nothing_moves_before_the_start_is_answered() {
    let mut machine = lot(&[PromptMoment::LotStart, PromptMoment::LotStart]);
    assert_eq!(opened(&mut machine), "0");
    rests(&mut machine);
    assert_eq!(machine.driven(), 0);
    let reset = machine.order(Order::Command(Command::Reset));
    assert_eq!(reset, Err(Refused::PromptOpen));
    assert_eq!(answer(&mut machine, "1", "done"), Err(Refused::NoPrompt));
    assert_eq!(
        answer(&mut machine, "0", "ready"),
        Err(Refused::NoSuchChoice)
    );
    for name in ["0", "1"] {
        assert_eq!(opened(&mut machine), name);
        assert_eq!(answer(&mut machine, name, "done"), Ok(()));
    }
    machine.run();
    assert_eq!(machine.ending, Some(Ending::Complete));
}

#[test]
fn a_stopping_answer_ends_the_run() {
    let mut machine = lot(&[PromptMoment::LotStart]);
    opened(&mut machine);
    assert_eq!(answer(&mut machine, "0", "stop"), Ok(()));
    assert_eq!(machine.ending, Some(Ending::Stopped));
    assert_eq!(machine.driven(), 0);
}

#[test]
fn first_part_and_end_wait_for_their_answers() {
    let mut machine = lot(&[
        PromptMoment::LotEnd,
        PromptMoment::BeforeCalibration,
        PromptMoment::AfterCalibration,
    ]);
    assert_eq!(opened(&mut machine), "2", "no calibration is due");
    rests(&mut machine);
    assert_eq!(machine.station.ledger().came_in, 0);
    assert_eq!(answer(&mut machine, "2", "done"), Ok(()));
    assert_eq!(opened(&mut machine), "0");
    rests(&mut machine);
    assert_eq!(machine.landed.len(), 1);
    assert_eq!(answer(&mut machine, "0", "done"), Ok(()));
    assert_eq!(machine.ending, Some(Ending::Complete));
}

#[test]
fn an_aborted_prompt_opens_again() {
    let moments = [PromptMoment::LotStart, PromptMoment::AfterCalibration];
    for (moment, way_back) in moments.into_iter().zip([
        &[Command::Clear][..],
        &[Command::Clear, Command::Reset, Command::Start],
    ]) {
        let mut machine = lot(&[moment]);
        opened(&mut machine);
        give(&mut machine, Command::Abort);
        machine.turn();
        assert!(machine.station.prompt().is_none());
        for command in way_back {
            give(&mut machine, *command);
        }
        assert_eq!(opened(&mut machine), "0");
        rests(&mut machine);
    }
}

/// Gives a command as soon as the state allows it.
fn give(machine: &mut Machine, command: Command) {
    for _ in 0..6000 {
        if machine.station.may(command).is_ok() {
            break;
        }
        machine.turn();
    }
    machine.order(Order::Command(command)).unwrap();
}

#[test]
fn prompts_need_names_and_a_way_on() {
    let of = |names: [&str; 2]| names.map(|it| prompt(it, PromptMoment::LotEnd));
    assert!(check(&of(["a", "b"])).is_ok());
    assert!(check(&of(["a", "a"])).is_err());
    let mut stuck = prompt("a", PromptMoment::LotEnd);
    stuck.choices.remove(0);
    assert!(check(&[stuck.clone()]).is_err());
    stuck.choices.clear();
    assert!(check(&[stuck]).is_err());
}
