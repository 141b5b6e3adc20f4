//! The 1 kHz thread: exchange, trajectory generator, control laws and guards
