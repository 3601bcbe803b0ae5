//! A restless person at the screen: disturbs a running lot, presses buttons that are dark, and brings the line up
//! again whatever state it is in. Ends the program when the lot is complete, or when patience is at its end, and ends
//! it at once when that takes too long.

use crate::dice::Dice;
use bus::Pace;
use machine::station::orders::JOGS;
use machine::station::packml::State;
use machine::view::{By, ORDERS, Order, OrderRequest, View};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tokio::sync::{mpsc, oneshot, watch};
use units::{RigTime, Span};

/// After so long the program is told to end, whatever it does, and after as long again to end at once.
const PATIENCE: Span = Span::ms(25_000);
/// One order and its answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Said {
    /// When it was answered, rig time of the life.
    pub at: RigTime,
    /// State seen before.
    pub state: String,
    /// Word of the order.
    pub order: String,
    /// Why it was refused; none when it was taken.
    pub refused: Option<String>,
}

/// The person.
pub struct Operator {
    /// View of the page.
    pub view: watch::Receiver<View>,
    /// Where orders go.
    pub orders: mpsc::Sender<OrderRequest>,
    /// Rig time.
    pub pace: Pace,
    /// Ends the program after the parts inside.
    pub stop: Arc<AtomicBool>,
    /// Ends it at once.
    pub abort: Arc<AtomicBool>,
    /// Draws orders and waits.
    pub dice: Dice,
    /// Receives every order with its answer.
    pub said: mpsc::UnboundedSender<Said>,
}

impl Operator {
    /// Until the lot is complete, the program gone, or patience at its end.
    pub async fn rage(mut self) {
        while self.pace.now() < RigTime(0) + PATIENCE {
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
            if let Some(order) = self.whim(known, &mode)
                && self.give(state, order).await.is_none()
            {
                return;
            }
        }
        self.stop.store(true, Ordering::Release);
        // A line that waits for steps or for a magazine does not finish the parts inside by itself.
        self.pace.sleep_until(self.pace.now() + PATIENCE).await;
        self.abort.store(true, Ordering::Release);
    }

    fn whim(&mut self, state: State, mode: &str) -> Option<Order> {
        let by_hand = mode == "manual" && state == State::Idle && self.dice.once_in(2);
        if by_hand || self.dice.once_in(12) {
            return Some(self.any(by_hand.then_some("jog")));
        }
        let word = *self.dice.one(sensible(state));
        let in_production = mode == "production";
        Some(Order {
            order: match word {
                "" => return None,
                "start" if !in_production => "mode".into(),
                word => word.into(),
            },
            mode: Some("production".into()),
            ..Order::default()
        })
    }

    /// Any button at all, or any motion by hand.
    fn any(&mut self, word: Option<&str>) -> Order {
        let any = *self.dice.one(&ORDERS);
        let mode = *self.dice.one(&["production", "maintenance", "manual"]);
        Order {
            order: word.unwrap_or(any).into(),
            mode: Some(mode.into()),
            motion: Some(self.dice.one(&JOGS).0.into()),
            reason: Some("storm".into()),
            ..Order::default()
        }
    }

    /// None when the program has gone.
    async fn give(&self, state: String, order: Order) -> Option<()> {
        let (answer, answered) = oneshot::channel();
        let word = order.order.clone();
        let by = By {
            who: "storm".to_owned(),
            role: "engineer".to_owned(),
            origin: "study".to_owned(),
        };
        let request = OrderRequest::new(order, by, move |it| drop(answer.send(it)));
        self.orders.send(request).await.ok()?;
        let answer = answered.await.ok()?;
        let said = Said {
            at: self.pace.now(),
            state,
            order: word,
            refused: answer.err().map(|why| why.say(texts::Lang::En)),
        };
        self.said.send(said).ok()
    }
}

/// What a person does in a state; an empty word is to look on.
fn sensible(state: State) -> &'static [&'static str] {
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
