"""Following a curve of solutions; knows neither friction nor hertz."""
