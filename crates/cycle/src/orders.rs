//! Receives orders from screens, hands them to the station, sends back the answers, and drives motions ordered by hand.

use super::{Cycle, Event, publish};
use machine::handling::mechanism::HandEnd;
use machine::handling::moves::Move;
use machine::station::orders::{Order, Refused};
use machine::station::turn::TurnOutput;
use machine::view::{AnsweredOrder, By, OrderRequest};
use texts::Message;
use units::RigTime;

/// Origin of an order given with a button at the machine.
pub const PANEL: &str = "panel";

/// Answer to a jog whose motion ended before the sensors showed its end position.
const NOT_ARRIVED: Result<Option<Message>, Refused> = Err(Refused::NotArrived);

/// Returns the refusal of an order that the program denied before it reached the station; `None` for any other order.
fn denied(asked: &OrderRequest) -> Option<Refused> {
    let why = asked.denied.clone()?;
    Some(Refused::Denied(Box::new(why)))
}

impl Cycle {
    /// Collects new orders and returns those for the station; refuses denied and unreadable ones at once.
    pub(super) fn orders(&mut self, now: RigTime) -> Vec<Order> {
        while let Ok(asked) = self.links.orders.try_recv() {
            self.pending_orders.push(asked);
        }
        let mut orders = Vec::new();
        for asked in std::mem::take(&mut self.pending_orders) {
            match denied(&asked).map_or_else(|| publish::read(&asked.order), Err) {
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
        let driven = output.rig.jog.take().map(|jog| jog.answer);
        let answers = asked.into_iter().zip(output.answers.drain(..));
        for (at, (asked, answer)) in answers.enumerate() {
            match driven == Some(at) {
                true => {
                    let earlier = self.jogging.replace(asked);
                    earlier
                        .into_iter()
                        .for_each(|it| self.send_answer(it, NOT_ARRIVED, now));
                }
                false => self.send_answer(asked, answer.map(|()| None), now),
            }
        }
        self.end_jog(now);
    }

    /// Refuses the orders that the end of a run leaves unanswered: the jog under way, and orders that have arrived
    /// since.
    pub(super) fn answer_the_rest(&mut self, now: RigTime) {
        if let Some(asked) = self.jogging.take() {
            self.send_answer(asked, NOT_ARRIVED, now);
        }
        while let Ok(asked) = self.links.orders.try_recv() {
            self.pending_orders.push(asked);
        }
        for asked in std::mem::take(&mut self.pending_orders) {
            let why = denied(&asked).unwrap_or(Refused::RunEnded);
            self.send_answer(asked, Err(why), now);
        }
    }

    /// Answers the jog under way once its motion has ended.
    fn end_jog(&mut self, now: RigTime) {
        let end = self.station.take_jog_end(now, &self.image);
        let Some((end, asked)) = end.and_then(|end| Some((end, self.jogging.take()?))) else {
            return;
        };
        let answer = match end {
            HandEnd::Arrived => Ok(None),
            HandEnd::ClosedOnNothing => Ok(Some(Message::new("remark", "closed_on_nothing"))),
            HandEnd::Cut => NOT_ARRIVED,
        };
        self.send_answer(asked, answer, now);
    }

    /// Records the orders given with buttons at the machine; no screen waits for an answer to them.
    pub(super) fn pressed(&self, output: &mut TurnOutput, now: RigTime) {
        for (command, answer) in output.pressed.drain(..) {
            let answered = AnsweredOrder {
                order: command.into(),
                by: By {
                    origin: PANEL.to_owned(),
                    ..By::default()
                },
                refused: answer.err().map(|why| why.message()),
            };
            self.send(Event::Ordered(Box::new(answered), now));
        }
    }

    /// Answers the sender and records the order with its answer.
    fn send_answer(
        &self,
        asked: OrderRequest,
        answer: Result<Option<Message>, Refused>,
        now: RigTime,
    ) {
        let said = answer.map_err(|why| why.message());
        let answered = AnsweredOrder {
            order: asked.order.clone(),
            by: asked.by.clone(),
            refused: said.clone().err(),
        };
        self.send(Event::Ordered(Box::new(answered), now));
        asked.answer(said);
    }

    /// Drives a jog; a refusal by the guard becomes the answer to the order and raises no alarm.
    pub(super) fn jog(&mut self, movement: Move, now: RigTime) -> Result<(), Refused> {
        let cleared = self.judge(movement, now).map_err(|refused| {
            let (situation, refusal) = *refused;
            self.refused = Some(self.refused_motion(movement, &situation, &refusal));
            Refused::Collision(Box::new(refusal.message()))
        })?;
        self.outputs.apply(cleared).map_err(|cannot| {
            Refused::Collision(Box::new(Message::detail("not_driven", cannot)))
        })?;
        self.station.driven(movement, now, &self.image);
        self.station.jogged(movement);
        self.refused = None;
        Ok(())
    }
}
