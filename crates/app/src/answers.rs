//! Answers that a person gives to prompts in advance, for a run without a screen.

use super::lot::{LotEvent, LotProgress, Subscriber};
use cycle::Event;
use machine::dut::prompt::Prompt;
use machine::view::{By, Order, OrderRequest};
use tokio::sync::mpsc;

/// Answers given in advance, and the person who gives them.
#[derive(Debug, Clone, Default)]
pub struct Answers {
    /// Person who answers, for the audit of orders.
    pub by: By,
    /// Pairs of a prompt's name and the name of the choice.
    pub given: Vec<(String, String)>,
}

impl Answers {
    /// Returns the choice for a prompt.
    pub fn choice(&self, prompt: &Prompt) -> Option<&str> {
        let mut given = self.given.iter();
        let (_, choice) = given.find(|(name, _)| *name == prompt.name)?;
        Some(choice)
    }
}

/// Passes every event to `outer`, and answers each prompt of the run.
pub(super) struct Answering<'a> {
    pub answers: &'a Answers,
    pub orders: mpsc::Sender<OrderRequest>,
    pub outer: &'a mut dyn Subscriber,
}

impl Subscriber for Answering<'_> {
    fn receive(&mut self, event: &LotEvent, lot: &LotProgress<'_>) {
        self.outer.receive(event, lot);
        let LotEvent::Cycle(Event::Prompted(prompt)) = event else {
            return;
        };
        if let Some(choice) = self.answers.choice(prompt) {
            let order = Order::Answer {
                prompt: prompt.name.clone(),
                choice: choice.to_owned(),
            };
            let request = OrderRequest::new(order, self.answers.by.clone(), drop);
            if self.orders.try_send(request).is_err() {
                tracing::error!("prompt {}: the run takes no answer", prompt.name);
            }
        }
    }
}
