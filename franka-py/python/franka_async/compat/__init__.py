"""Layers that offer the interfaces of other packages on top of this package: a program changes one import line.

* :mod:`franka_async.compat.franka` for programs that were written for ``franka`` of the distribution ``franka-rs``;
* :mod:`franka_async.compat.pylibfranka` for programs that were written for the vendor's ``pylibfranka``.

The book lists the differences under "Programs written for other packages".
"""
