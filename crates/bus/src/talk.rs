//! One transaction on an open port, with the rest, the doubts or the way back into step that belong to it.

use super::LineSettings;
use super::exchange::{Exchange, Frame, Heard, Quiet};
use super::owing::{Owing, question};
use super::trust::Trust;
use dcon::{Address, Command, Reply, ReplyError};
use std::io;
use std::mem::{replace, take};
use tokio::io::{AsyncRead, AsyncWrite};
use units::RigTime;

/// What a try ran into; made into a [`super::LineError`] where line and command are known.
pub(super) enum Trouble {
    Reply(ReplyError),
    TimeOut,
    Echo,
    SecondReply,
    OutOfStep,
    Contradicted,
    NeverSilent,
    Broken(io::ErrorKind),
    NoPort,
}

impl From<io::Error> for Trouble {
    fn from(error: io::Error) -> Self {
        Self::Broken(error.kind())
    }
}

/// The module heard the question: it replied, or declined.
fn is_answer(result: &Result<Reply, Trouble>) -> bool {
    match result {
        Ok(_) => true,
        Err(Trouble::Reply(reason)) => reason.is_answer(),
        Err(_) => false,
    }
}

/// When a try was asked and answered.
#[derive(Default)]
pub(super) struct Times {
    pub(super) asked_at: RigTime,
    pub(super) answered_at: Option<RigTime>,
}

/// A port and what is known of the line behind it.
pub(super) struct Talk<'a, P> {
    pub(super) exchange: Exchange<'a, P>,
    pub(super) settings: &'a LineSettings,
    pub(super) owing: &'a mut Owing,
    pub(super) trust: &'a mut Trust,
    /// False after trouble, until the line has been silent for long enough.
    pub(super) silent: &'a mut bool,
}

impl<P: AsyncRead + AsyncWrite + Unpin> Talk<'_, P> {
    /// Asks `command`, already written out as `request`; what was heard is in `frame`.
    pub(super) async fn transact(
        &mut self,
        command: &Command,
        request: &[u8],
        frame: &mut Frame,
        times: &mut Times,
    ) -> Result<Reply, Trouble> {
        if !*self.silent {
            let rest = self.settings.silence(command);
            let now = self.now();
            let quiet = self
                .exchange
                .silence(rest, now, now + rest + rest, |_| false)
                .await?;
            *self.silent = quiet != Quiet::Noisy;
            return Err(Trouble::NeverSilent);
        }
        self.exchange.discard().await?;
        let Some(address) = command.address() else {
            times.asked_at = self.now();
            return self.tell(request).await;
        };
        let result = self.attempt(command, address, request, frame, times).await;
        if !is_answer(&result) {
            return result;
        }
        let checksum = self.settings.checksum;
        if self.owing.doubts(frame.bytes(), checksum, self.now()) {
            return match self.confirmed(command, address, request, frame).await? {
                true => result,
                false => Err(Trouble::OutOfStep),
            };
        }
        match result {
            Ok(first) if self.trust.on_probation(address) && command.repeatable() => {
                self.repeated(command, address, request, frame, times, first)
                    .await
            }
            result => result,
        }
    }

    /// Asked once, and led back into step if that was no answer.
    async fn attempt(
        &mut self,
        command: &Command,
        address: Address,
        request: &[u8],
        frame: &mut Frame,
        times: &mut Times,
    ) -> Result<Reply, Trouble> {
        times.asked_at = self.now();
        let result = self.ask(command, request, frame, times).await;
        self.weigh(address, frame, &result);
        if !is_answer(&result) && !matches!(result, Err(Trouble::Broken(_))) {
            self.find_step(command, address).await?;
        }
        result
    }

    /// A whole answer speaks for its address, damage against it. Silence and an echo say nothing of a second
    /// module.
    fn weigh(&mut self, address: Address, frame: &Frame, result: &Result<Reply, Trouble>) {
        if is_answer(result) {
            self.trust.whole(address);
        } else if !frame.bytes().is_empty() && !matches!(result, Err(Trouble::Echo)) {
            self.trust.damaged(address);
        }
    }

    /// Asks again until one of the answers can be believed ([`Command::believed`]): a second time, and a third if the
    /// module is prompt enough to be asked thrice in the time that two late answers take.
    async fn repeated(
        &mut self,
        command: &Command,
        address: Address,
        request: &[u8],
        frame: &mut Frame,
        times: &mut Times,
        first: Reply,
    ) -> Result<Reply, Trouble> {
        let begun = times.asked_at;
        let third_until = begun + self.settings.time_out(command) + self.settings.turnaround();
        let mut answers = vec![first];
        let mut heard = Vec::with_capacity(2);
        loop {
            heard.push((replace(frame, Frame::new()), take(times)));
            let next = self
                .attempt(command, address, request, frame, times)
                .await?;
            answers.push(next);
            assert_eq!(answers.len(), heard.len() + 1, "an answer unheard");
            assert!(answers.len() <= 3, "asked a fourth time");
            let apart_ms = self.now().since(begun).0.div_ceil(1_000);
            if let Some(place) = command.believed(&answers, apart_ms) {
                assert!(place < answers.len(), "believed what was not heard");
                if let Some(earlier) = heard.into_iter().nth(place) {
                    (*frame, *times) = earlier;
                }
                return Ok(answers[place]);
            }
            if answers.len() == 3 || self.now() > third_until {
                self.trust.damaged(address);
                return Err(Trouble::Contradicted);
            }
        }
    }

    fn now(&self) -> RigTime {
        self.exchange.pace.now()
    }

    async fn tell(&mut self, request: &[u8]) -> Result<Reply, Trouble> {
        let wire = self.settings.wire().time(request.len());
        let over = self.now() + wire + self.settings.turnaround();
        self.exchange.tell(request, over).await?;
        self.exchange.pace.rest_until(over).await;
        Ok(Reply::Sent)
    }

    /// Question and reply, and the rest in which nothing more may come.
    async fn ask(
        &mut self,
        command: &Command,
        request: &[u8],
        frame: &mut Frame,
        times: &mut Times,
    ) -> Result<Reply, Trouble> {
        let limit = self.settings.time_out_of(command, request.len());
        let heard = self
            .exchange
            .ask(request, self.now() + limit, frame)
            .await?;
        times.answered_at = Some(self.now());
        let result = judge(command, self.settings.checksum, request, frame, heard);
        if self.rests().await? || !is_answer(&result) {
            return result;
        }
        Err(Trouble::SecondReply)
    }

    /// Waits for the turnaround; false when somebody talked into it.
    async fn rests(&mut self) -> io::Result<bool> {
        let over = self.now() + self.settings.turnaround();
        self.exchange.pace.rest_until(over).await;
        Ok(self.exchange.discard().await? == 0)
    }

    /// The module says the same again and names itself, with nothing between.
    async fn confirmed(
        &mut self,
        command: &Command,
        address: Address,
        request: &[u8],
        first: &Frame,
    ) -> Result<bool, Trouble> {
        let mut same = false;
        if command.repeatable() {
            let mut second = Frame::new();
            let again = self
                .ask(command, request, &mut second, &mut Times::default())
                .await;
            if let Err(Trouble::Broken(kind)) = again {
                return Err(Trouble::Broken(kind));
            }
            same = is_answer(&again) && second.bytes() == first.bytes();
        }
        Ok(self.find_step(command, address).await? && same)
    }

    /// Asks the module who it is until it answers, for as long as a silence would have to last. True when it did, and
    /// nothing else was heard. Every reply that `address` owes and that is not proved to have come stays owed.
    async fn find_step(&mut self, command: &Command, address: Address) -> Result<bool, Trouble> {
        self.owing.owed(*command, self.now());
        let checksum = self.settings.checksum;
        let mut alone = true;
        let limit = self.now() + self.settings.step_limit(command, address);
        let patience = self.settings.time_out(&question(address));
        // Once at least: the clock goes on between two lines of code. The name is given in microseconds or not before
        // its time-out, so the limit ends this.
        let last_heard = loop {
            let ask_name = self.owing.question(address);
            self.owing.owed(ask_name, self.now());
            let owing = &mut *self.owing;
            let in_step =
                |frame: &[u8]| owing.settle(address, frame, checksum) && !owing.owes(command);
            let deadline = self.exchange.pace.now() + patience;
            let named = self
                .exchange
                .name(&ask_name, checksum, deadline, in_step)
                .await?;
            alone &= !named.strays;
            if named.by_module && self.rests().await? {
                return Ok(alone);
            }
            if self.now() + patience > limit {
                break named.last_heard;
            }
        };
        let rest = self.settings.silence(command);
        let limit = self.now() + rest;
        let owing = &mut *self.owing;
        let in_step = |frame: &[u8]| owing.settle(address, frame, checksum) && !owing.owes(command);
        let quiet = self
            .exchange
            .silence(rest, last_heard, limit, in_step)
            .await?;
        *self.silent = quiet != Quiet::Noisy;
        if quiet == Quiet::Named {
            self.rests().await?;
        }
        Ok(false)
    }
}

/// Whether what was heard is the reply to `command`.
fn judge(
    command: &Command,
    checksum: bool,
    request: &[u8],
    frame: &Frame,
    heard: Heard,
) -> Result<Reply, Trouble> {
    match heard {
        Heard::Nothing => Err(Trouble::TimeOut),
        Heard::TooLong => Err(Trouble::Reply(ReplyError::TooLong {
            length: frame.bytes().len(),
        })),
        Heard::Whole | Heard::More if frame.bytes() == request => Err(Trouble::Echo),
        Heard::More => Err(Trouble::SecondReply),
        Heard::Whole => command
            .decode(frame.bytes(), checksum)
            .map_err(Trouble::Reply),
    }
}
