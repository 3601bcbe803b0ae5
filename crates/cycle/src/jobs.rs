//! Starts a measuring job: hands its parts to the lines, to the instruments, or to the converter.

use super::Cycle;
use super::converter::Finished;
use super::traffic::Purpose;
use machine::instrument::act::Job;
use machine::rig::level::Correction;
use machine::station::trouble::Alarm;
use texts::Message;

impl Cycle {
    /// Starts a measuring job: writes its outputs together with those of the turn, and queues its readings.
    pub(super) fn start(&mut self, job: Job) {
        self.traffic.begin_job();
        let commands = match job {
            Job::Set(outputs) => {
                for (point, on) in outputs {
                    self.set_output(point, on);
                }
                Vec::new()
            }
            Job::Level(outputs) => {
                for (output, volts) in outputs {
                    if let Err(cannot) = self.outputs.set_supply(output, volts, Correction::NONE) {
                        self.note_alarm(Alarm::bus(&Message::detail("not_driven", cannot)));
                    }
                }
                Vec::new()
            }
            Job::Read(points) => self.wiring.reads(&points),
            Job::Restarts => self.traffic.measuring_resets(),
            Job::Query(queries) => {
                self.start_queries(&queries);
                Vec::new()
            }
            Job::Convert(conversion, waveforms) => {
                self.traffic.conversion_begun();
                let convert = move || Finished::Converted(conversion.run(&waveforms));
                self.converter.begin(convert);
                Vec::new()
            }
            Job::Mask(inputs) => self.wiring.masks(&inputs),
        };
        for (line, command) in commands {
            self.traffic.queue(line, command, Purpose::Job);
        }
    }
}
