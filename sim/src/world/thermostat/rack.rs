//! The rack: sockets with their own temperatures, and the parts in them.

use super::part::Thermostat;
use super::table::RackTable;
use super::truth::SocketTruth;
use crate::config::{OFFSETS_AT_K, Socket as SocketSpec};
use crate::world::draw::Draw;
use crate::world::edges::Edges;
use crate::world::oven::Delay;

/// A part in a socket.
#[derive(Debug, Clone)]
struct Loaded {
    seq: u64,
    batch: u64,
    part: Thermostat,
}

/// A socket.
#[derive(Debug, Clone)]
struct Socket {
    number: u64,
    select: u8,
    /// Temperature of the socket minus that of the air, kelvin, with the air 75 K above ambient.
    offset_k: f64,
    delay: Delay,
    emf_v: f64,
    /// True when a wire to the contact is broken.
    broken: bool,
    loaded: Option<Loaded>,
    edges: Edges,
}

/// All sockets.
#[derive(Debug, Clone)]
pub struct Rack {
    sockets: Vec<Socket>,
    ambient_c: f64,
    /// Truth of the parts that have left the rack.
    left: Vec<SocketTruth>,
}

impl Rack {
    /// Creates an empty rack at ambient temperature; `stated_k`: offsets of the sockets by a certificate, if there is one.
    pub fn new(
        (specs, stated_k): (&[SocketSpec], &[f64]),
        table: &RackTable,
        emf_uv_sd: f64,
        ambient_c: f64,
        draw: &mut Draw,
    ) -> Self {
        let mut socket = |(place, spec): (usize, &SocketSpec)| {
            let drawn_k = draw.normal(0.0, table.offset_sd_k);
            let delay_s = draw.normal(table.delay_mean_s, table.delay_sd_s);
            let beside_k = draw.normal(0.0, table.certificate_sd_k);
            let offset_k = stated_k.get(place).map_or(drawn_k, |it| it + beside_k);
            let mut edges = Edges::default();
            edges.begin(true, 0);
            Socket {
                number: spec.number,
                select: spec.select,
                offset_k,
                delay: Delay::new(delay_s, ambient_c),
                emf_v: draw.normal(0.0, emf_uv_sd * 1e-6),
                broken: false,
                loaded: None,
                edges,
            }
        };
        Self {
            sockets: specs.iter().enumerate().map(&mut socket).collect(),
            ambient_c,
            left: Vec::new(),
        }
    }

    /// Returns the number of sockets.
    pub fn size(&self) -> usize {
        self.sockets.len()
    }

    /// Checks whether any socket holds a part.
    pub fn is_filled(&self) -> bool {
        self.sockets.iter().any(|it| it.loaded.is_some())
    }

    /// Breaks a wire to the contact of the socket with this number; returns false when the rack has no such socket.
    pub fn break_wire(&mut self, number: u64, now_us: u64) -> bool {
        let found = self.sockets.iter_mut().find(|it| it.number == number);
        found.is_some_and(|socket| {
            socket.broken = true;
            socket.edges.level(true, now_us);
            true
        })
    }

    /// Puts a part into the socket at `place`.
    pub fn load(&mut self, place: usize, (seq, batch): (u64, u64), part: Thermostat, now_us: u64) {
        let socket = &mut self.sockets[place];
        let closed = part.contact().is_closed() && !socket.broken;
        socket.edges.level(!closed, now_us);
        socket.loaded = Some(Loaded { seq, batch, part });
    }

    /// Takes all parts out.
    pub fn unload(&mut self, now_us: u64) {
        let truths = self.loaded_truths();
        self.left.extend(truths);
        for socket in &mut self.sockets {
            socket.loaded = None;
            socket.edges.level(true, now_us);
        }
    }

    /// Advances from `from_us` by `dt_s`, in which the air goes to `air_c`.
    pub fn step(&mut self, from_us: u64, dt_s: f64, air_c: f64) {
        for socket in &mut self.sockets {
            let delayed_c = socket.delay.step(dt_s, air_c);
            let offset_k = socket.offset_k * (delayed_c - self.ambient_c) / OFFSETS_AT_K;
            if let Some(loaded) = &mut socket.loaded {
                loaded.part.step(from_us, dt_s, delayed_c + offset_k);
            }
        }
    }

    /// Carries out the changes of all contacts up to `t_us`.
    pub fn settle(&mut self, t_us: u64) {
        for socket in &mut self.sockets {
            let Some(loaded) = &mut socket.loaded else {
                continue;
            };
            while let Some((at_us, closed)) = loaded.part.contact_mut().next(t_us) {
                socket.edges.level(!closed || socket.broken, at_us);
            }
        }
    }

    /// Checks whether the contact of the socket at `place` is closed.
    pub fn is_closed(&self, place: usize) -> bool {
        let socket = &self.sockets[place];
        let contact = |loaded: &Loaded| loaded.part.contact().is_closed();
        !socket.broken && socket.loaded.as_ref().is_some_and(contact)
    }

    /// Returns the number of falling edges at the input of the socket at `place`.
    pub fn edges(&mut self, place: usize, now_us: u64) -> u64 {
        self.sockets[place].edges.count(now_us)
    }

    /// Returns the voltage across the contact that the multiplexer selects, volts, from a source of `amps` with a
    /// compliance of `most_v`; 0 for a number without a socket.
    pub fn drop_v(&mut self, select: u8, amps: f64, most_v: f64) -> f64 {
        let Some(socket) = self.sockets.iter_mut().find(|it| it.select == select) else {
            return 0.0;
        };
        let broken = socket.broken;
        let part = socket.loaded.as_mut().map(|it| &mut it.part);
        let ohm = part.as_ref().and_then(|it| it.ohm()).filter(|_| !broken);
        match ohm {
            Some(ohm) => {
                if let Some(part) = part.filter(|_| amps > 0.0) {
                    part.measured();
                }
                (amps * ohm).min(most_v) + socket.emf_v
            }
            None if amps > 0.0 => most_v,
            None => 0.0,
        }
    }

    /// Returns the truth of every part that has been in the rack, in order of loading.
    pub fn truths(&self) -> Vec<SocketTruth> {
        let mut all = self.left.clone();
        all.extend(self.loaded_truths());
        all.sort_by_key(|it| it.seq);
        all
    }

    fn loaded_truths(&self) -> Vec<SocketTruth> {
        let each = self.sockets.iter();
        let truth = |socket: &Socket| {
            let loaded = socket.loaded.as_ref()?;
            Some(SocketTruth {
                seq: loaded.seq,
                socket: socket.number,
                batch: loaded.batch,
                part: loaded.part.truth(),
            })
        };
        each.filter_map(truth).collect()
    }
}
