//! The examples run, and their assertions hold.

#[path = "../examples/pick.rs"]
mod pick;
#[path = "../examples/render_to_buffer.rs"]
mod render_to_buffer;

#[test]
fn every_example_runs() {
    pick::main().unwrap();
    render_to_buffer::main().unwrap();
}
