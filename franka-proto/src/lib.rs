//! Wire protocol of Franka robots as values: bytes to meaning and back, for both sides
