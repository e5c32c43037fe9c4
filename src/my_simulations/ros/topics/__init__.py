"""Published topics, and the threads behind them."""
