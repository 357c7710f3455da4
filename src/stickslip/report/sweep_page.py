def write_sweep_page(path, *a):
    path.write_text("x")
