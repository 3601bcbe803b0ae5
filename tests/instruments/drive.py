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
    unit.apply_current(current_range=1e-3, compliance_voltage=10)
    unit.source_current = 1e-3
    unit.measure_voltage(nplc=1, voltage=2, auto_range=False)
    check("smu: voltage", unit.voltage, 1.0, 2e-3)
    unit.measure_resistance(nplc=1, resistance=2e3, auto_range=True)
    check("smu: resistance", unit.resistance, 1000.0, 3e-3)
    unit.disable_source()
    check("smu: source", unit.source_enabled, False)
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
    source.output = True
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
