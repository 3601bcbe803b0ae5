//! Receives orders from screens, hands them to the station, sends back the answers, and drives motions ordered by hand.

use super::{Cycle, Event, publish};
use machine::handling::moves::Move;
use machine::station::orders::{Order, Refused};
use machine::station::turn::TurnOutput;
use machine::view::{self, AnsweredOrder, By, OrderRequest};
use texts::Lang;
use units::RigTime;

/// Origin of an order given with a button at the machine.
pub const PANEL: &str = "panel";

impl Cycle {
    /// Collects new orders and returns those for the station; refuses denied and unreadable ones at once.
    pub(super) fn orders(&mut self, now: RigTime) -> Vec<Order> {
        while let Ok(asked) = self.links.orders.try_recv() {
            self.pending_orders.push(asked);
        }
        let mut orders = Vec::new();
        for asked in std::mem::take(&mut self.pending_orders) {
            let denied = asked
                .denied
                .as_ref()
                .map(|why| Refused::Denied(why.clone()));
            match denied.map_or_else(|| publish::read(&asked.order), Err) {
                Ok(order) => {
                    orders.push(order);
                    self.pending_orders.push(asked);
                }
                Err(why) => self.send_answer(asked, Err(why), now),
            }
        }
        let pending = self.pending_orders.len();
        assert_eq!(orders.len(), pending, "an order without its request");
        orders
    }

    pub(super) fn answer(&mut self, output: &mut TurnOutput, now: RigTime) {
        let (orders, answers) = (self.pending_orders.len(), output.answers.len());
        assert_eq!(orders, answers, "orders and answers differ in number");
        let asked: Vec<_> = self.pending_orders.drain(..).collect();
        for (asked, answer) in asked.into_iter().zip(output.answers.drain(..)) {
            self.send_answer(asked, answer, now);
        }
    }

    /// Records the orders given with buttons at the machine; no screen waits for an answer to them.
    pub(super) fn pressed(&self, output: &mut TurnOutput, now: RigTime) {
        for (command, answer) in output.pressed.drain(..) {
            let answered = AnsweredOrder {
                order: view::Order {
                    order: command.name().to_owned(),
                    ..view::Order::default()
                },
                by: By {
                    origin: PANEL.to_owned(),
                    ..By::default()
                },
                refused: answer.err().map(|why| why.message().say(Lang::En)),
            };
            self.send(Event::Ordered(Box::new(answered), now));
        }
    }

    /// Answers the sender and records the order with its answer.
    fn send_answer(&self, asked: OrderRequest, answer: Result<(), Refused>, now: RigTime) {
        let said = answer.map_err(|why| why.message());
        let answered = AnsweredOrder {
            order: asked.order.clone(),
            by: asked.by.clone(),
            refused: said.as_ref().err().map(|why| why.say(Lang::En)),
        };
        self.send(Event::Ordered(Box::new(answered), now));
        asked.answer(said);
    }

    /// Drives a motion ordered by hand; a refusal is the answer to the order, not an alarm.
    pub(super) fn jog(&mut self, movement: Move, now: RigTime) -> Result<(), Refused> {
        let situation = self.station.situation(now, &self.image);
        let cleared = self
            .guard
            .clear(&self.station.motion(movement), &situation)
            .map_err(|refusal| {
                self.refused = Some(self.refused_motion(movement, &situation, &refusal));
                Refused::Collision(refusal.to_string())
            })?;
        self.outputs
            .apply(cleared)
            .map_err(|cannot| Refused::Collision(cannot.to_string()))?;
        self.station.driven(movement, now, &self.image);
        self.station.jogged();
        self.refused = None;
        Ok(())
    }
}
