//! A simulated Franka robot that speaks the wire protocol
