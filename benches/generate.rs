//! Prints a generated model: `cargo bench --bench generate -- 10000 > line.chart`.

mod generator;

fn main() {
    let states = std::env::args().skip(1).find_map(|a| a.parse().ok()).unwrap_or(1000);
    print!("{}", generator::model(states));
}
