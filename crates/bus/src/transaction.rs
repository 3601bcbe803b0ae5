//! One transaction on an open port, with its turnaround, its confirmation and the resynchronisation after trouble.
//!
//! A late reply (one to an earlier request, which timed out) is dropped in four places:
//!
//! 1. before the request: [`Exchange::discard`] empties the input;
//! 2. after the request: [`OutstandingReplies::could_be`] recognises a reply that may be late, and the transaction
//!    rejects it unless [`Transaction::confirm`] proves that the module meant it;
//! 3. while resynchronising: [`Transaction::resynchronise`] discards what arrives before the module names itself, or
//!    before the line falls silent; the next transaction goes on waiting for that silence;
//! 4. after a reply: when more bytes arrive during the turnaround ([`Transaction::rest`]), the line drops the reply and
//!    those bytes, because either may be late.

use super::exchange::{Exchange, Frame, FrameEnd, SilenceEnd};
use super::outstanding::{OutstandingReplies, identification};
use super::probation::Probation;
use super::{Failure, LineSettings};
use dcon::{Address, Command, Reply, ReplyError};
use std::io;
use std::mem::{replace, take};
use units::RigTime;

/// Returns true when the module understood the request: it replied or refused.
fn is_answer(result: &Result<Reply, Failure>) -> bool {
    result.as_ref().map_or_else(Failure::is_answer, |_| true)
}

/// Times at which a try began and was answered.
#[derive(Default)]
pub(super) struct Times {
    pub(super) requested_at: RigTime,
    pub(super) answered_at: Option<RigTime>,
}

/// The objects of a transaction: an open port, and what the line remembers about its modules.
pub(super) struct Transaction<'a> {
    pub(super) exchange: Exchange<'a>,
    pub(super) settings: &'a LineSettings,
    pub(super) outstanding: &'a mut OutstandingReplies,
    pub(super) probation: &'a mut Probation,
    /// False after trouble, until the line has been silent for the required time.
    pub(super) silent: &'a mut bool,
}

impl Transaction<'_> {
    /// Carries out `command`, whose bytes are `request`; leaves the bytes received in `frame`.
    pub(super) async fn transact(
        &mut self,
        command: &Command,
        request: &[u8],
        frame: &mut Frame,
        times: &mut Times,
    ) -> Result<Reply, Failure> {
        if !*self.silent {
            let rest = self.settings.silence(command);
            let now = self.now();
            let quiet = self
                .exchange
                .silence(rest, now, now + rest + rest, |_| false)
                .await?;
            *self.silent = quiet != SilenceEnd::Noisy;
            return Err(Failure::NeverSilent);
        }
        self.exchange.discard().await?;
        let Some(address) = command.address() else {
            times.requested_at = self.now();
            return self.broadcast(request).await;
        };
        let result = self.attempt(command, address, request, frame, times).await;
        if !is_answer(&result) {
            return result;
        }
        let checksum = self.settings.checksum;
        if self
            .outstanding
            .could_be(frame.bytes(), checksum, self.now())
        {
            return match self.confirm(command, address, request, frame).await? {
                true => result,
                false => Err(Failure::OutOfStep),
            };
        }
        match result {
            Ok(first) if self.probation.applies_to(address) && command.repeatable() => {
                self.read_again(command, address, request, frame, times, first)
                    .await
            }
            result => result,
        }
    }

    /// Sends the request once, and resynchronises unless the module answered.
    async fn attempt(
        &mut self,
        command: &Command,
        address: Address,
        request: &[u8],
        frame: &mut Frame,
        times: &mut Times,
    ) -> Result<Reply, Failure> {
        times.requested_at = self.now();
        let result = self.ask(command, request, frame, times).await;
        self.update_probation(address, frame, &result);
        if !is_answer(&result) && !matches!(result, Err(Failure::PortLost(_))) {
            self.resynchronise(command, address).await?;
        }
        result
    }

    /// Counts a whole answer towards the end of the address's probation; starts the probation at a damaged answer.
    /// Silence and an echo change nothing, because neither shows that a second module exists.
    fn update_probation(
        &mut self,
        address: Address,
        frame: &Frame,
        result: &Result<Reply, Failure>,
    ) {
        if is_answer(result) {
            self.probation.count_whole(address);
        } else if !frame.bytes().is_empty() && !matches!(result, Err(Failure::Echo)) {
            self.probation.start(address);
        }
    }

    /// Repeats the command until the answers agree well enough to choose one ([`Command::select_answer`]). It repeats
    /// once, and once more if the module is prompt enough to answer three times within the time of two late answers.
    async fn read_again(
        &mut self,
        command: &Command,
        address: Address,
        request: &[u8],
        frame: &mut Frame,
        times: &mut Times,
        first: Reply,
    ) -> Result<Reply, Failure> {
        let begun = times.requested_at;
        let third_until = begun + self.settings.time_out(command) + self.settings.turnaround();
        let mut answers = vec![first];
        let mut heard = Vec::with_capacity(2);
        loop {
            heard.push((replace(frame, Frame::new()), take(times)));
            let next = self
                .attempt(command, address, request, frame, times)
                .await?;
            answers.push(next);
            assert_eq!(
                answers.len(),
                heard.len() + 1,
                "answers and frames differ in number"
            );
            assert!(answers.len() <= 3, "more than three answers");
            let apart_ms = self.now().since(begun).0.div_ceil(1_000);
            if let Some(place) = command.select_answer(&answers, apart_ms) {
                assert!(place < answers.len(), "the chosen answer does not exist");
                if let Some(earlier) = heard.into_iter().nth(place) {
                    (*frame, *times) = earlier;
                }
                return Ok(answers[place]);
            }
            if answers.len() == 3 || self.now() > third_until {
                self.probation.start(address);
                return Err(Failure::Contradicted);
            }
        }
    }

    fn now(&self) -> RigTime {
        self.exchange.pace.now()
    }

    async fn broadcast(&mut self, request: &[u8]) -> Result<Reply, Failure> {
        let wire = self.settings.wire().time(request.len());
        let over = self.now() + wire + self.settings.turnaround();
        self.exchange.broadcast(request, over).await?;
        self.exchange.timer.until(over).await;
        Ok(Reply::Sent)
    }

    /// Sends the request and reads the reply; rejects an answer when bytes arrive during the following turnaround.
    async fn ask(
        &mut self,
        command: &Command,
        request: &[u8],
        frame: &mut Frame,
        times: &mut Times,
    ) -> Result<Reply, Failure> {
        let limit = self.settings.time_out_of(command, request.len());
        let heard = self
            .exchange
            .ask(request, self.now() + limit, frame)
            .await?;
        times.answered_at = Some(self.now());
        let result = decode(command, self.settings, request, frame, heard);
        if self.rest().await? || !is_answer(&result) {
            return result;
        }
        Err(Failure::SecondReply)
    }

    /// Waits for the turnaround; returns false when bytes arrived during it, and discards them.
    async fn rest(&mut self) -> io::Result<bool> {
        let over = self.now() + self.settings.turnaround();
        self.exchange.timer.until(over).await;
        Ok(self.exchange.discard().await? == 0)
    }

    /// Returns true when the module confirms its reply: it repeats the reply and then names itself, with no other bytes
    /// in between.
    async fn confirm(
        &mut self,
        command: &Command,
        address: Address,
        request: &[u8],
        first: &Frame,
    ) -> Result<bool, Failure> {
        let mut same = false;
        if command.repeatable() {
            let mut second = Frame::new();
            let again = self
                .ask(command, request, &mut second, &mut Times::default())
                .await;
            if let Err(lost @ Failure::PortLost(_)) = again {
                return Err(lost);
            }
            same = is_answer(&again) && second.bytes() == first.bytes();
        }
        Ok(self.resynchronise(command, address).await? && same)
    }

    /// Asks the module for its name until it answers, for as long as the required silence would last. Returns true when
    /// it answered and no other bytes arrived. Otherwise a reply of `address` that may still arrive stays outstanding.
    async fn resynchronise(
        &mut self,
        command: &Command,
        address: Address,
    ) -> Result<bool, Failure> {
        self.outstanding.add(*command, self.now());
        let checksum = self.settings.checksum;
        let mut alone = true;
        let limit = self.now() + self.settings.resynchronisation_limit(command, address);
        let name_time_out = self.settings.time_out(&identification(address));
        // The loop runs at least once, because the clock may advance between two lines of code. Each round lasts from
        // some microseconds to one time-out, so that the limit ends the loop.
        let last_heard = loop {
            let ask_name = self.outstanding.identification(address);
            self.outstanding.add(ask_name, self.now());
            let outstanding = &mut *self.outstanding;
            let in_step = |frame: &[u8]| {
                outstanding.settle(address, frame, checksum) && !outstanding.contains(command)
            };
            let deadline = self.exchange.pace.now() + name_time_out;
            let named = self
                .exchange
                .name(&ask_name, checksum, deadline, in_step)
                .await?;
            alone &= !named.strays;
            if named.by_module && self.rest().await? {
                return Ok(alone);
            }
            if self.now() + name_time_out > limit {
                break named.last_heard;
            }
        };
        let rest = self.settings.silence(command);
        let limit = self.now() + rest;
        let outstanding = &mut *self.outstanding;
        let in_step = |frame: &[u8]| {
            outstanding.settle(address, frame, checksum) && !outstanding.contains(command)
        };
        let quiet = self
            .exchange
            .silence(rest, last_heard, limit, in_step)
            .await?;
        *self.silent = quiet != SilenceEnd::Noisy;
        if quiet == SilenceEnd::Named {
            self.rest().await?;
        }
        Ok(false)
    }
}

/// Decodes the frame received as the reply to `command`.
fn decode(
    command: &Command,
    settings: &LineSettings,
    request: &[u8],
    frame: &Frame,
    heard: FrameEnd,
) -> Result<Reply, Failure> {
    match heard {
        FrameEnd::TimedOut => Err(Failure::TimeOut(
            settings.time_out_of(command, request.len()),
        )),
        FrameEnd::TooLong => Err(Failure::Reply(ReplyError::TooLong {
            length: frame.bytes().len(),
        })),
        FrameEnd::Whole | FrameEnd::More if frame.bytes() == request => Err(Failure::Echo),
        FrameEnd::More => Err(Failure::SecondReply),
        FrameEnd::Whole => command
            .decode(frame.bytes(), settings.checksum)
            .map_err(Failure::Reply),
    }
}
