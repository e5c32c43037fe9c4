"""HTTP, web sockets and messages between the page and the simulator."""
