//! Orders of screens: taken in, handed to the station, answered; and motions by hand.

use super::{Cycle, Event, publish};
use machine::handling::moves::Move;
use machine::station::orders::{Order, Refused};
use machine::station::turn::TurnOutput;
use machine::view::{self, AnsweredOrder, By, OrderRequest};
use texts::Lang;
use units::RigTime;

/// Origin of what is ordered with a button at the machine.
pub const PANEL: &str = "panel";

impl Cycle {
    /// Orders that have come in; one that is denied or no order is answered at once.
    pub(super) fn orders(&mut self, now: RigTime) -> Vec<Order> {
        while let Ok(asked) = self.links.orders.try_recv() {
            self.asked.push(asked);
        }
        let mut orders = Vec::new();
        for asked in std::mem::take(&mut self.asked) {
            let denied = asked
                .denied
                .as_ref()
                .map(|why| Refused::Denied(why.clone()));
            match denied.map_or_else(|| publish::read(&asked.order), Err) {
                Ok(order) => {
                    orders.push(order);
                    self.asked.push(asked);
                }
                Err(why) => self.say(asked, Err(why), now),
            }
        }
        assert_eq!(orders.len(), self.asked.len(), "an order lost its way back");
        orders
    }

    pub(super) fn answer(&mut self, output: &mut TurnOutput, now: RigTime) {
        let (orders, answers) = (self.asked.len(), output.answers.len());
        assert_eq!(orders, answers, "orders without their answers");
        let asked: Vec<_> = self.asked.drain(..).collect();
        for (asked, answer) in asked.into_iter().zip(output.answers.drain(..)) {
            self.say(asked, answer, now);
        }
    }

    /// Buttons at the machine have no screen to answer to: the audit hears of them.
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
            self.tell(Event::Ordered(Box::new(answered), now));
        }
    }

    /// Sends the answer to the sender of the order and records it in the audit.
    fn say(&self, asked: OrderRequest, answer: Result<(), Refused>, now: RigTime) {
        let said = answer.map_err(|why| why.message());
        let answered = AnsweredOrder {
            order: asked.order.clone(),
            by: asked.by.clone(),
            refused: said.as_ref().err().map(|why| why.say(Lang::En)),
        };
        self.tell(Event::Ordered(Box::new(answered), now));
        asked.answer(said);
    }

    /// A motion by hand: refused is an answer to who asked, not an alarm.
    pub(super) fn jog(&mut self, movement: Move, now: RigTime) -> Result<(), Refused> {
        let situation = self.station.situation(now, &self.image);
        let cleared = self
            .guard
            .clear(&self.station.motion(movement), &situation)
            .map_err(|refusal| {
                self.refused = Some(self.shown_refused(movement, &situation, &refusal));
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
