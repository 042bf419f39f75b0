//! Sweeps in the layouts that instruments export, made here; each must be read as the plain one.

use super::*;
use std::f64::consts::TAU;

const FREQUENCIES_HZ: [f64; 4] = [0.1, 1.0, 10.0, 100.0];
const TEMPERATURES_C: [f64; 2] = [-20.0, 20.0];

/// Storage and loss modulus in MPa.
fn moduli(frequency_hz: f64, temperature_c: f64) -> [f64; 2] {
    let storage = 5.5 * (frequency_hz * 10_f64.powf(-temperature_c / 20.0)).powf(0.125);
    [storage, 0.25 * storage]
}

/// Frequency in Hz, storage and loss in MPa of every row.
fn rows(temperature_c: f64) -> impl Iterator<Item = [f64; 3]> {
    FREQUENCIES_HZ.into_iter().map(move |frequency| {
        let [storage, loss] = moduli(frequency, temperature_c);
        [frequency, storage, loss]
    })
}

fn read(text: &str) -> SweepTable {
    parse_sweeps(text, &TableOptions::default(), 1.0).unwrap_or_else(|e| panic!("{e:?}\n{text}"))
}

fn assert_right(table: &SweepTable) {
    let found: Vec<f64> =
        table.sweeps.iter().map(|sweep| sweep.temperature_c.unwrap_or(f64::NAN)).collect();
    assert_eq!(found, TEMPERATURES_C);
    for sweep in &table.sweeps {
        assert_eq!(sweep.points.len(), FREQUENCIES_HZ.len());
        let mut points = sweep.points.clone();
        points.sort_by(|a, b| a.angular_frequency.total_cmp(&b.angular_frequency));
        for (point, frequency) in points.iter().zip(FREQUENCIES_HZ) {
            let [storage, loss] = moduli(frequency, sweep.temperature_c.unwrap());
            // Six decimals of the angular frequencies below.
            for (found, right) in [
                (point.angular_frequency, TAU * frequency),
                (point.storage_modulus, 1e6 * storage),
                (point.loss_modulus, 1e6 * loss),
            ] {
                approx::assert_relative_eq!(found, right, max_relative = 1e-5);
            }
        }
    }
}

/// TA Instruments TRIOS, text: a step for each temperature, names, units, tabs.
fn trios() -> String {
    let mut text = String::from("Filename\tsweeps.tri\nInstrument type\tRSA-G2\n\n");
    for temperature in TEMPERATURES_C {
        text += &format!("[step]\nFrequency sweep - {temperature} °C\n");
        text += "Angular frequency\tStep time\tTemperature\tStorage modulus\tLoss modulus\tTan(delta)\n";
        text += "rad/s\ts\t°C\tPa\tPa\t\n";
        for [f, s, l] in rows(temperature) {
            text +=
                &format!("{:.6}\t12.5\t{temperature}\t{}\t{}\t0.25\n", TAU * f, 1e6 * s, 1e6 * l);
        }
        text.push('\n');
    }
    text
}

/// Anton Paar RheoCompass: intervals, a row of units in brackets, an empty first column.
fn rheocompass() -> String {
    let mut text = String::from("Project:\tsweeps\nTest:\tFrequency sweep\n\n");
    for temperature in TEMPERATURES_C {
        text += "Result:\tsweep\nInterval and data points:\t1\t4\n";
        text += "Interval data:\tPoint No.\tTemperature\tFrequency\tStorage Modulus\tLoss Modulus\tStatus\n";
        text += "\t\t\t\t\t\t\n\t\t[°C]\t[Hz]\t[kPa]\t[kPa]\t\n";
        for (k, [f, s, l]) in rows(temperature).enumerate() {
            text += &format!("\t{k}\t{temperature}\t{f}\t{}\t{}\tDy_auto\n", 1e3 * s, 1e3 * l);
        }
        text.push('\n');
    }
    text
}

/// Netzsch Proteus: keys behind one `#`, names behind two, decimal comma.
fn proteus() -> String {
    let mut text =
        String::from("#EXPORTTYPE:DATA ALL\n#SEPARATOR:SEMICOLON\n#DECIMAL:COMMA\n#MTYPE:DMA\n\n");
    text += "##Temp./°C;Time/min;f/Hz;E'/MPa;E\"/MPa;tan d\n";
    for temperature in TEMPERATURES_C {
        for [f, s, l] in rows(temperature) {
            text += &format!("{temperature};1;{f};{s};{l};0.25\n").replace('.', ",");
        }
    }
    text.replace("Temp,", "Temp.")
}

/// Netzsch Eplexor: short names, units below, commas.
fn eplexor() -> String {
    let mut text = String::from("f,E_stor,E_loss,T\nHz,MPa,MPa,°C\n");
    for temperature in TEMPERATURES_C {
        for [f, s, l] in rows(temperature) {
            text += &format!("{f},{s},{l},{temperature}\n");
        }
    }
    text
}

/// Mettler-Toledo STARe: blanks, `t` is the time, `Ts` the temperature of the sample.
fn stare() -> String {
    let mut text = String::from("Curve Name:\n  sweeps\nCurve Values:\n");
    text += "  Index       t      f        Ts         M'        M\"\n";
    text += "             [s]    [Hz]     [°C]      [MPa]     [MPa]\n";
    for temperature in TEMPERATURES_C {
        for (k, [f, s, l]) in rows(temperature).enumerate() {
            text += &format!("  {k}  1.5  {f}  {temperature}  {s}  {l}\n");
        }
    }
    text
}

/// Kelvin, loss factor in place of the loss modulus.
fn kelvin() -> String {
    let mut text = String::from("temperature_k;frequency_hz;storage_gpa;loss_factor\n");
    for temperature in TEMPERATURES_C {
        for [f, s, l] in rows(temperature) {
            text += &format!("{:.2};{f};{};{}\n", temperature + 273.15, s / 1e3, l / s);
        }
    }
    text
}

#[test]
fn layouts_of_instruments_are_read_as_they_are() {
    for text in [trios(), rheocompass(), proteus(), eplexor(), stare(), kelvin()] {
        assert_right(&read(&text));
        assert_right(&read(&text.replace('\n', "\r\n")));
    }
    assert!(read(&proteus()).read_as.contains("decimal comma"));
    assert_eq!(read(&proteus()).symbol, Some('E'));
}

#[test]
fn files_are_read_in_their_encodings_and_as_workbooks() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sweeps");
    let read = || read_sweeps(&path, &TableOptions::default(), 1.0);
    let utf16: Vec<u8> = rheocompass().encode_utf16().flat_map(u16::to_le_bytes).collect();
    std::fs::write(&path, [vec![0xff, 0xfe], utf16].concat()).unwrap();
    assert_right(&read().unwrap());
    let latin1: Vec<u8> = proteus().chars().map(|c| c as u32 as u8).collect();
    std::fs::write(&path, latin1).unwrap();
    assert_right(&read().unwrap());

    let mut workbook = rust_xlsxwriter::Workbook::new();
    workbook.add_worksheet().set_name("notes").unwrap().write(0, 0, "a sample").unwrap();
    for name in ["sweeps", "again"] {
        let sheet = workbook.add_worksheet().set_name(name).unwrap();
        for (column, (name, unit)) in
            [("Frequency", "Hz"), ("E'", "MPa"), ("E''", "MPa"), ("Temperature", "°C")]
                .into_iter()
                .enumerate()
        {
            sheet.write(2, column as u16, name).unwrap();
            sheet.write(3, column as u16, unit).unwrap();
        }
        let all =
            TEMPERATURES_C.into_iter().flat_map(|t| rows(t).map(move |[f, s, l]| [f, s, l, t]));
        for (row, values) in all.enumerate() {
            for (column, value) in values.into_iter().enumerate() {
                sheet.write(4 + row as u32, column as u16, value).unwrap();
            }
        }
    }
    std::fs::write(&path, workbook.save_to_buffer().unwrap()).unwrap();
    let error = read().unwrap_err().to_string();
    assert!(error.contains("several sheets") && error.contains("--sheet"), "{error}");
    let sheet = |name: &str| {
        let sheet = Some(name.to_owned());
        read_sweeps(&path, &TableOptions { sheet, ..TableOptions::default() }, 1.0)
    };
    assert_right(&sheet("again").unwrap());
    let error = sheet("third").unwrap_err().to_string();
    assert!(error.contains("notes, sweeps, again"), "{error}");
}

#[test]
fn described_columns_need_no_header() {
    let mut text = String::from("my sweeps\n\n");
    for temperature in TEMPERATURES_C {
        for [f, s, l] in rows(temperature) {
            text += &format!("x {l} {s} {:.6} {temperature}\n", TAU * f);
        }
    }
    let columns = |texts: &[&str]| TableOptions {
        columns: texts.iter().map(|text| text.parse().unwrap()).collect(),
        ..TableOptions::default()
    };
    let right = ["angular_frequency_rad_s=4", "storage_mpa=3", "loss_mpa=2", "temperature_c=5"];
    assert_right(&parse_sweeps(&text, &columns(&right), 1.0).unwrap());
    let failure = |texts: &[&str]| parse_sweeps(&text, &columns(texts), 1.0).unwrap_err().1;
    assert!(failure(&right[..2]).contains("does not say where the loss modulus is"));
    assert!(
        failure(&["frequency_hz=9", "storage_mpa=3", "loss_mpa=2"]).contains("no line has numbers")
    );
    assert!(failure(&["frequency_hz=a", "storage_mpa=3", "loss_mpa=2"]).contains("such as `a`"));
    assert!(failure(&["frequency_hz=0", "storage_mpa=3", "loss_mpa=2"]).contains("number 1"));
    for (text, part) in [
        ("storage=3", "with its unit"),
        ("storage_mpa", "has no `=`"),
        ("x_pa=1", "names no quantity"),
    ] {
        let error = text.parse::<DescribedColumn>().unwrap_err();
        assert!(error.contains(part), "{text}: {error}");
    }
    let named = "F;Stor;Lo\n1;2;1\n10;3;1,5\n";
    let by_name = columns(&["frequency_hz=F", "storage_mpa=stor", "loss_mpa=Lo"]);
    assert_eq!(parse_sweeps(named, &by_name, 1.0).unwrap().sweeps[0].points[1].loss_modulus, 1.5e6);
}

#[test]
fn decimal_marks_are_told_or_asked_for() {
    let failure = |text: &str| parse_sweeps(text, &TableOptions::default(), 1.0).unwrap_err();
    let header = "frequency_hz;storage_mpa;loss_mpa\n";
    let table = read(&format!("{header}1,5;2;1\n10;3;1\n"));
    approx::assert_relative_eq!(table.sweeps[0].points[0].angular_frequency, 1.5 * TAU);
    let (line, text) = failure(&format!("{header}1;1,234;1\n10;3;1\n"));
    assert!(
        line == Some(2) && text.contains("`1,234`") && text.contains("--decimal-mark"),
        "{text}"
    );
    let (line, text) = failure(&format!("{header}1;2;1\n10;1,234.5;1\n"));
    assert!(line == Some(3) && text.contains("`1,234.5`"), "{text}");
    let comma = TableOptions { decimal_mark: Some(DecimalMark::Comma), ..TableOptions::default() };
    let table = parse_sweeps(&format!("{header}1;1,234;1\n10;3;1\n"), &comma, 1.0).unwrap();
    assert_eq!(table.sweeps[0].points[0].storage_modulus, 1.234e6);
}

#[test]
fn shift_factors_are_read_and_checked() {
    let factors = |text: &str| factors_of(&of_text(text, None), &TableOptions::default());
    let read = factors("# temperature_c  shift_factor\n0 1e3\n20.5 1\n").unwrap();
    assert_eq!(
        read,
        [
            GivenShift { temperature_c: 0.0, log10_shift: 3.0 },
            GivenShift { temperature_c: 20.5, log10_shift: 0.0 },
        ]
    );
    assert_eq!(factors("T/K;log aT\n273,15;3\n293,65;-1,5\n").unwrap()[1].log10_shift, -1.5);
    for (text, part) in [
        ("temperature_c,shift_factor\n0,-1\n1,1\n", "shift_factor is -1"),
        ("temperature_c,shift_factor\n0,1\n0,2\n", "second time"),
        ("temperature_c,shift_factor\n0,1\n", "fewer than two"),
        ("temperature_c\n0\n1\n", "no column of the logarithm of the shift factor"),
    ] {
        let error = factors(text).unwrap_err().1;
        assert!(error.contains(part), "{text}: {error}");
    }
}
