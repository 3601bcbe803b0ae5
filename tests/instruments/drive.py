"""Drives the simulated instruments with pyvisa-py and the drivers of pymeasure.

drive.py PROGRAM [ARGUMENT...]: PROGRAM serves `bench.toml` and prints its addresses on the first line. The last line of
stdout counts the checks that passed.
"""

import json
import statistics
import subprocess
import sys

import pyvisa
from pymeasure.adapters import VISAAdapter
from pymeasure.instruments.agilent import Agilent33220A, Agilent34410A
from pymeasure.instruments.keithley import Keithley2450
from pymeasure.instruments.keysight import KeysightDSOX1102G

passed = 0


def check(what, found, expected, within=0.0):
    global passed
    if isinstance(expected, float):
        good = abs(found - expected) <= within * abs(expected)
    else:
        good = found == expected
    if not good:
        sys.exit(f"{what}: found {found!r}, expected {expected!r}")
    passed += 1


def clean(instrument, what):
    check(f"{what}: error queue", instrument.query("SYST:ERR?").strip(), '0,"No error"')


def settings(link):
    kind, place, number = link.split(":")[:3]
    ends = {"read_termination": "\n", "write_termination": "\n", "timeout": 20000}
    if kind == "serial":
        return f"ASRL{place}::INSTR", ends
    return f"TCPIP0::{place}::{number}::SOCKET", ends


def smu(address):
    name, ends = settings(address)
    unit = Keithley2450(VISAAdapter(name, visa_library="@py", **ends))
    raw = unit.adapter.connection
    check("smu: identity", "MODEL 2450" in unit.id, True)
    check("smu: language", raw.query("*LANG?").strip(), "SCPI")
    unit.reset()
    unit.apply_voltage(voltage_range=20, compliance_current=0.05)
    unit.source_voltage = 4
    unit.measure_current(nplc=0.1, current=0.01, auto_range=False)
    raw.write(":SENS:CURR:RSEN ON")
    unit.enable_source()
    check("smu: current", unit.current, 4e-3, 2e-3)
    check("smu: compliance", unit.compliance_current, 0.05, 1e-6)
    raw.write(":SOUR:SWE:VOLT:LIN:STEP 1.5,4,0.05,0.002")
    raw.write("INIT")
    raw.write("*WAI")
    numbers = raw.query_ascii_values('TRAC:DATA? 1,51,"defbuffer1",SOUR,READ')
    check("smu: points", len(numbers), 102)
    check("smu: last point", numbers[101], 4e-3, 2e-3)
    check("smu: mean", unit.means, 2.75e-3, 5e-3)
    check("smu: greatest", unit.maximums, 4e-3, 2e-3)
    check("smu: least", unit.minimums, 1.5e-3, 5e-3)
    check("smu: scatter", unit.standard_devs, 0.736e-3, 3e-2)
    # What the programs `source`, `current_range` and `step` of the profile set, by the properties of the driver.
    for mode in ["current", "voltage"]:
        unit.source_mode = mode
        check("smu: source mode", unit.source_mode, mode)
    for name, value in [("source_voltage_range", 20.0), ("compliance_current", 0.02), ("current_range", 0.01),
                        ("current_nplc", 1.0), ("source_voltage", 2.0)]:
        setattr(unit, name, value)
        check(f"smu: {name}", getattr(unit, name), value, 1e-6)
    check("smu: current in its range", unit.current, 2e-3, 2e-3)
    unit.ramp_to_voltage(3.0, steps=5, pause=1e-3)
    check("smu: current after a ramp", unit.current, 3e-3, 2e-3)
    unit.apply_current(current_range=1e-3, compliance_voltage=10)
    unit.source_current = 1e-3
    unit.measure_voltage(nplc=1, voltage=2, auto_range=False)
    check("smu: voltage", unit.voltage, 1.0, 2e-3)
    for name, value in [("source_current_range", 1e-3), ("compliance_voltage", 10.0), ("voltage_range", 2.0),
                        ("voltage_nplc", 1.0)]:
        setattr(unit, name, value)
        check(f"smu: {name}", getattr(unit, name), value, 1e-6)
    # The program `drops_over_time`: one query measures several times, another one reads all.
    for command in [":SENS:VOLT:RSEN ON", ':TRAC:CLE "defbuffer1"', ":SENS:COUN 5", ":SOUR:CURR 5e-4", ":OUTP ON"]:
        raw.write(command)
    check("smu: last of five", float(raw.query(":READ?")), 0.5, 2e-3)
    drops = raw.query_ascii_values('TRAC:DATA? 1,5,"defbuffer1",READ')
    check("smu: five drops", len(drops), 5)
    check("smu: first drop", drops[0], 0.5, 2e-3)
    raw.write(":SENS:COUN 1")
    unit.measure_resistance(nplc=1, resistance=2e3, auto_range=True)
    check("smu: resistance", unit.resistance, 1000.0, 3e-3)
    unit.disable_source()
    check("smu: source", unit.source_enabled, False)
    unit.apply_voltage(voltage_range=20, compliance_current=0.05)
    unit.enable_source()
    check("smu: source on", unit.source_enabled, True)
    unit.shutdown()
    check("smu: source after shutdown", unit.source_enabled, False)
    clean(raw, "smu")


def dmm(address):
    name, ends = settings(address)
    meter = Agilent34410A(VISAAdapter(name, visa_library="@py", baud_rate=9600, **ends))
    raw = meter.adapter.connection
    check("dmm: identity", "34461A" in meter.id, True)
    raw.write("SYST:REM")
    check("dmm: resistance", meter.resistance, 1000.0, 2e-3)
    check("dmm: four wires", meter.resistance_4w, 1000.0, 2e-3)
    check("dmm: no voltage", abs(meter.voltage_dc) < 1e-3, True)
    check("dmm: no current", abs(meter.current_dc) < 1e-6, True)
    for command in ["CONF:CURR:DC 0.0001", "SENS:CURR:DC:NPLC 1", "TRIG:SOUR IMM", "SAMP:COUN 3"]:
        raw.write(command)
    check("dmm: samples", len(raw.query_ascii_values("READ?")), 3)
    raw.write("INIT")
    check("dmm: fetched", len(raw.query_ascii_values("FETC?")), 3)
    raw.write("SAMP:COUN 1")
    for command in ["CONF:VOLT:DC 10", "SENS:VOLT:DC:NPLC 10"]:
        raw.write(command)
    check("dmm: averaging time", float(raw.query("SENS:VOLT:DC:NPLC?")), 10.0, 1e-6)
    check("dmm: voltage in its range", abs(float(raw.query("READ?"))) < 1e-3, True)
    raw.write("ABOR")
    raw.write("NONSENSE")
    check("dmm: error", raw.query("SYST:ERR?").strip(), '-113,"Undefined header"')
    clean(raw, "dmm")


def ac_source(manager, address):
    _, host, port, _ = address.split(":")
    adapter = manager.open_resource(f"PRLGX-TCPIP0::{host}::{port}::INTFC")
    adapter.write_raw(b"++read_tmo_ms 3000\n")
    source = manager.open_resource("GPIB0::9::INSTR", timeout=20000)
    check("ac: identity", source.query("*IDN?").startswith("Chroma"), True)
    for command in ["VOLT:LIM:AC 250", "VOLT:AC 230", "FREQ 50", "CURR:LIM 2", "PHAS:ON 0", "PHAS:OFF 0", "OUTP ON"]:
        source.write(command)
    check("ac: voltage", float(source.query("MEAS:VOLT:AC?")), 230.0, 0.05)
    check("ac: current", float(source.query("MEAS:CURR:AC?")), 0.1, 0.3)
    check("ac: frequency", float(source.query("MEAS:FREQ?")), 50.0, 1e-3)
    source.write("VOLT:AC 24.5")
    check("ac: level of the loop", float(source.query("MEAS:VOLT:AC?")), 24.5, 0.08)
    source.write("OUTP OFF")
    check("ac: off", abs(float(source.query("MEAS:VOLT:AC?"))) < 1.0, True)
    clean(source, "ac")
    return adapter, source


def second_dmm(manager, address):
    _, path, _, _ = address.split(":")
    adapter = manager.open_resource(f"PRLGX-ASRL1::{path}::INTFC")
    adapter.write_raw(b"++read_tmo_ms 3000\n")
    meter = manager.open_resource("GPIB1::22::INSTR", timeout=20000)
    check("gpib over serial: identity", "34461A" in meter.query("*IDN?"), True)
    check("gpib over serial: resistance", float(meter.query("MEAS:RES?")), 1000.0, 2e-3)
    clean(meter, "gpib over serial")
    return adapter, meter


def pulses(address):
    name, ends = settings(address)
    source = Agilent33220A(VISAAdapter(name, visa_library="@py", baud_rate=57600, **ends))
    source.shape = "PULS"
    source.adapter.connection.write("OUTP:LOAD INF")
    source.pulse_period = 0.02
    source.pulse_width = 0.01
    source.voltage_high = 5.0
    source.voltage_low = 0.0
    check("pulses: high", source.voltage_high, 5.0, 1e-6)
    check("pulses: period", source.pulse_period, 0.02, 1e-6)
    check("pulses: width", source.pulse_width, 0.01, 1e-6)
    # The programs `train` and `start`: a burst that waits for its trigger.
    for name, value in [("burst_mode", "TRIG"), ("trigger_source", "BUS")]:
        setattr(source, name, value)
        check(f"pulses: {name}", getattr(source, name).strip(), value)
    source.burst_ncycles = 6
    check("pulses: burst_ncycles", source.burst_ncycles, 6.0, 1e-6)
    source.burst_state = True
    check("pulses: burst_state", source.burst_state, True)
    source.output = True
    check("pulses: output", source.output, True)
    source.trigger()
    source.wait_for_trigger(timeout=20)
    source.burst_state = False
    check("pulses: errors", source.check_errors(), [])
    clean(source.adapter.connection, "pulses")


def rigol(manager, address):
    name, ends = settings(address)
    digitizer = manager.open_resource(name, **ends)
    digitizer.chunk_size = 1 << 20
    for command in [":CHAN1:SCAL 2", ":CHAN2:PROB 100", ":CHAN2:SCAL 100", ":TIM:SCAL 0.02", ":TRIG:EDGE:SOUR CHAN1",
                    ":TRIG:EDGE:LEV 2", ":SING"]:
        digitizer.write(command)
    check("rigol: complete", digitizer.query("*OPC?").strip(), "1")
    check("rigol: stopped", digitizer.query(":TRIG:STAT?").strip(), "STOP")
    for command in [":WAV:SOUR CHAN1", ":WAV:MODE RAW", ":WAV:FORM WORD", ":WAV:STAR 1", ":WAV:STOP 20000"]:
        digitizer.write(command)
    preamble = digitizer.query_ascii_values(":WAV:PRE?")
    check("rigol: points", preamble[2], 20000.0)
    step_v, origin, reference = preamble[7:]
    codes = digitizer.query_binary_values(":WAV:DATA?", datatype="H", is_big_endian=False)
    check("rigol: codes", len(codes), 20000)
    volts = [(code - origin - reference) * step_v for code in codes]
    high = [value for value in volts if value > 2.0]
    check("rigol: half the time high", len(high) / 20000, 0.5, 0.01)
    # 2 % of the reading and 0.2 V, as its profile states.
    check("rigol: high", statistics.median(high), 5.0, 0.06)
    digitizer.write(":WAV:FORM BYTE")
    check("rigol: bytes", len(digitizer.query_binary_values(":WAV:DATA?", datatype="B")), 20000)
    # The program `capture_all_falling` with `force_trigger`, and a record of another length.
    for command in [":WAV:FORM WORD", ":ACQ:MDEP 1000", ":TIM:MAIN:SCAL 0.002", ":TIM:MAIN:OFFS 0.0096",
                    ":TRIG:EDGE:SLOP NEG", ":TRIG:EDGE:LEV -4", ":SING"]:
        digitizer.write(command)
    check("rigol: waits", digitizer.query(":TRIG:STAT?").strip() in ["RUN", "WAIT"], True)
    digitizer.write(":TFOR")
    check("rigol: forced", digitizer.query("*OPC?").strip(), "1")
    preamble = digitizer.query_ascii_values(":WAV:PRE?")
    check("rigol: points of the record", preamble[2], 1000.0)
    check("rigol: interval", preamble[4], 2e-5, 1e-6)
    check("rigol: begin", preamble[5], -4e-4, 1e-6)
    clean(digitizer, "rigol")


def keysight(address):
    name, ends = settings(address)
    scope = KeysightDSOX1102G(VISAAdapter(name, visa_library="@py", **ends))
    raw = scope.adapter.connection
    raw.chunk_size = 1 << 20
    scope.ch1.scale = 2.0
    check("keysight: range", scope.ch1.range, 16.0, 1e-6)
    scope.timebase_scale = 0.01
    raw.write(":TRIG:EDGE:SOUR CHAN1;LEV 2")
    scope.digitize("channel1")
    check("keysight: complete", raw.query("*OPC?").strip(), "1")
    scope.waveform_source = "channel1"
    scope.waveform_format = "word"
    raw.write(":WAV:BYT LSBF")
    preamble = scope.waveform_preamble
    codes = raw.query_binary_values(":WAV:DATA?", datatype="H", is_big_endian=False)
    check("keysight: codes", len(codes), 20000)
    volts = [(code - preamble["yreference"]) * preamble["yincrement"] + preamble["yorigin"] for code in codes]
    check("keysight: high", max(volts), 5.0 / 1.05, 0.03)  # 50 ohm drive 1 kohm
    scope.timebase_offset = 0.0096
    check("keysight: offset", scope.timebase_offset, 0.0096, 1e-6)
    scope.timebase_scale = 0.002
    check("keysight: timebase", scope.timebase_range, 0.02, 1e-6)
    scope.stop()
    raw.write(":TRIG:EDGE:SLOP NEG")
    raw.write(":TRIG:EDGE:LEV -4")
    scope.single()
    check("keysight: acquires", int(raw.query(":OPER:COND?")) & 8, 8)
    raw.write(":TRIG:FORC")
    check("keysight: forced", raw.query("*OPC?").strip(), "1")
    check("keysight: complete record", int(raw.query(":OPER:COND?")) & 8, 0)
    scope.waveform_points = 1000
    check("keysight: points", scope.waveform_points, 1000.0, 1e-6)
    for channel in ["channel1", "channel2"]:
        scope.waveform_source = channel
        check("keysight: source", scope.waveform_source, channel)
    words = raw.query_binary_values(":WAV:DATA?", datatype="H", is_big_endian=False)
    check("keysight: words", len(words), 1000)
    clean(raw, "keysight")


def main():
    served = subprocess.Popen(sys.argv[1:], stdout=subprocess.PIPE, text=True)
    try:
        at = json.loads(served.stdout.readline())["instruments"]
        manager = pyvisa.ResourceManager("@py")
        smu(at["smu"])
        dmm(at["dmm"])
        pulses(at["pulses"])
        rigol(manager, at["rigol"])
        keysight(at["keysight"])
        kept = [ac_source(manager, at["ac_source"])]
        kept.append(second_dmm(manager, at["second_dmm"]))
    finally:
        served.terminate()
        served.wait()
    print(f"passed {passed}")


main()
