//! A simulated operator: gives sensible and random orders, including orders that the station refuses, and restarts the
//! line from any state. The operator ends the program when the lot is complete or after [`LIFE_TIMEOUT`], and aborts a
//! program that still runs [`LIFE_TIMEOUT`] later.

use crate::dice::Dice;
use bus::Pace;
use machine::station::orders::JOGS;
use machine::station::packml::{Command, Mode, State};
use machine::view::{By, Order, OrderRequest, View};
use serde_json::json;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tokio::sync::{mpsc, oneshot, watch};
use units::{RigTime, Span};

/// Longest time until the operator ends the program, and from there until it aborts the program.
const LIFE_TIMEOUT: Span = Span::ms(25_000);

/// Words of orders to the rig that are not PackML commands.
const OTHER_WORDS: &[&str] = &["mode", "jog", "step", "lamp_test", "acknowledge", "shelve"];

/// One order and its answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answered {
    /// Time of the answer, in rig time of the life.
    pub at: RigTime,
    /// PackML state before the order.
    pub state: String,
    /// Name of the order.
    pub order: String,
    /// Reason of a refusal; `None` for an accepted order.
    pub refused: Option<String>,
}

/// The simulated operator.
pub struct Operator {
    /// Latest view of the station.
    pub view: watch::Receiver<View>,
    /// Channel to the station.
    pub orders: mpsc::Sender<OrderRequest>,
    /// Clock of the rig time.
    pub pace: Pace,
    /// Request to end the program once the parts inside are finished.
    pub stop: Arc<AtomicBool>,
    /// Request to end the program at once.
    pub abort: Arc<AtomicBool>,
    /// Random numbers for orders and waits.
    pub dice: Dice,
    /// Receives every order with its answer.
    pub answers: mpsc::UnboundedSender<Answered>,
}

impl Operator {
    /// Gives orders until the lot is complete, the program has ended, or [`LIFE_TIMEOUT`] is over.
    pub async fn operate(mut self) {
        while self.pace.now() < RigTime(0) + LIFE_TIMEOUT {
            let wait = Span::ms(self.dice.between(50, 2_000));
            self.pace.sleep_until(self.pace.now() + wait).await;
            let (state, mode) = {
                let view = self.view.borrow_and_update();
                (view.machine.state.clone(), view.machine.mode.clone())
            };
            let Some(known) = State::from_name(&state) else {
                continue;
            };
            if known == State::Complete {
                break;
            }
            if let Some(order) = self.next_order(known, &mode)
                && self.send_order(state, order).await.is_none()
            {
                return;
            }
        }
        self.stop.store(true, Ordering::Release);
        // A line that waits for single steps or for a magazine never finishes the parts inside by itself.
        self.pace.sleep_until(self.pace.now() + LIFE_TIMEOUT).await;
        self.abort.store(true, Ordering::Release);
    }

    fn next_order(&mut self, state: State, mode: &str) -> Option<Order> {
        let by_hand = mode == "manual" && state == State::Idle && self.dice.once_in(2);
        if by_hand || self.dice.once_in(12) {
            return Some(self.random_order(by_hand.then_some("jog")));
        }
        let word = *self.dice.one(usual_orders(state));
        let in_production = mode == "production";
        match word {
            "" => None,
            "start" if !in_production => Some(order("mode", "production", "")),
            word => Some(order(word, "production", "")),
        }
    }

    /// Draws an order of the given word, or of a random one; also draws the mode of `mode` and the motion of `jog`.
    fn random_order(&mut self, word: Option<&str>) -> Order {
        let random_order = *self.dice.one(&[Command::NAMES, OTHER_WORDS].concat());
        let mode = *self.dice.one(Mode::NAMES);
        let motion = self.dice.one(&JOGS).code();
        order(word.unwrap_or(random_order), mode, motion)
    }

    /// Sends an order and waits for its answer; `None` when the program has ended.
    async fn send_order(&self, state: String, order: Order) -> Option<()> {
        let (answer, answered) = oneshot::channel();
        let word = order.word();
        let by = By {
            who: "storm".to_owned(),
            role: "engineer".to_owned(),
            origin: "study".to_owned(),
        };
        let request = OrderRequest::new(order, by, move |it| drop(answer.send(it)));
        self.orders.send(request).await.ok()?;
        let answer = answered.await.ok()?;
        let answers = Answered {
            at: self.pace.now(),
            state,
            order: word,
            refused: answer.err().map(|why| why.say(texts::Lang::En)),
        };
        self.answers.send(answers).ok()
    }
}

/// Returns the order with this word; only `mode` uses `mode`, only `jog` uses `motion`. `shelve` names an unknown
/// alarm, so that the station refuses it.
fn order(word: &str, mode: &str, motion: &str) -> Order {
    let json = match word {
        "mode" => json!({"order": word, "mode": mode}),
        "jog" => json!({"order": word, "motion": motion}),
        "shelve" => json!({"order": word, "alarm": "storm", "reason": "storm"}),
        word => json!({"order": word}),
    };
    serde_json::from_value(json).unwrap_or_else(|error| panic!("{word}: {error}"))
}

/// Returns the orders that make sense in a state; an empty name means no order.
fn usual_orders(state: State) -> &'static [&'static str] {
    match state {
        State::Execute => &[
            "",
            "",
            "",
            "",
            "",
            "",
            "hold",
            "suspend",
            "stop",
            "abort",
            "lamp_test",
            "complete",
        ],
        State::Held => &["acknowledge", "unhold", "unhold", "abort"],
        State::Suspended => &["unsuspend", "unsuspend", "hold", "abort"],
        State::Aborted => &["clear", "clear", "acknowledge"],
        State::Stopped => &["reset"],
        State::Idle => &["start"],
        State::Complete => &["reset"],
        State::Resetting
        | State::Starting
        | State::Completing
        | State::Holding
        | State::Unholding
        | State::Suspending
        | State::Unsuspending
        | State::Stopping
        | State::Aborting
        | State::Clearing => &["", "", "", "", "", "hold", "stop", "abort"],
    }
}
